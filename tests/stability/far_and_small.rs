//! Accuracy of hits far from the origin, and with tiny and huge triangles together.

use umber_bench::stability::{DISTANCES, SCALES, hits};

use crate::rays;

#[test]
fn no_triangle_is_too_small_or_too_far() {
    let count = rays(20_000);
    let mut textbook_missed = 0;
    for size in SCALES {
        // Corners a thousand spacings apart at least.
        for distance in DISTANCES.into_iter().filter(|d| size >= d * 1e-4) {
            let counts = hits::at(size, distance, count);
            println!("size {size:e}, distance {distance:e}: {counts:?}");
            assert_eq!((counts.missed, counts.off), (0, 0), "size {size:e}, distance {distance:e}");
            textbook_missed += counts.textbook_missed;
        }
    }
    assert!(textbook_missed > count as u64 / 4, "the textbook's test missed only {textbook_missed}");
}

#[test]
fn tiny_and_huge_triangles_together() {
    let count = rays(20_000);
    let [ours, textbook] = hits::tiny_over_huge(count);
    println!("tiny over huge: {ours} of {count} wrong, textbook {textbook}");
    assert_eq!(ours, 0);
    assert!(textbook > count as u64 / 2, "the textbook's test was wrong only {textbook} times");
}
