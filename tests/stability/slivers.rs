//! Triangles that get ever thinner.

use umber_bench::stability::slivers;

use crate::rays;

#[test]
fn thin_triangles_are_met_as_long_as_numbers_tell_their_inside() {
    let count = rays(50_000);
    for ratio in [1.0, 1e2, 1e4, 1e5] {
        let counts = slivers::at(ratio, count);
        println!("ratio {ratio:e}: {counts:?}");
        assert_eq!(counts.missed, 0, "ratio {ratio:e}");
        assert!(counts.rays > count as u64 / 2, "ratio {ratio:e}: few rays tell anything");
    }
    // Here the height is that of a few roundings.
    let thinnest = slivers::at(1e6, count);
    println!("ratio 1e6: {thinnest:?}");
    assert!(thinnest.missed < thinnest.textbook_missed / 2, "{thinnest:?}");
}

#[test]
fn closed_meshes_of_slivers_do_not_leak() {
    let (count, mut textbook_leaks) = (rays(20_000), 0);
    for ratio in [1.0, 1e2, 1e4, 1e6] {
        let [ours, textbook] = slivers::closed(ratio, count);
        println!("ratio {ratio:e}: {ours:?}, textbook {textbook:?}");
        assert_eq!(ours.leaks, 0, "ratio {ratio:e}");
        textbook_leaks = textbook.leaks;
    }
    assert!(textbook_leaks > count as u64 / 2, "the textbook's test leaked only {textbook_leaks} times");
}
