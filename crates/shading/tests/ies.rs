//! IES files: forms, versions, and broken ones.

use std::path::Path;

use umber_shading::{IesError, IesProfile};

const PLAIN: &str =
    "IESNA:LM-63-1995\n[TEST] a, b\nTILT=NONE\n1 1000 2 3 1 1 2 0.1 0.1 0\n0.5 1 20\n0 45 90\n0\n4 2 0\n";

fn at(text: &str, vertical_deg: f32) -> f32 {
    IesProfile::from_text(text).unwrap().intensity(vertical_deg.to_radians(), 0.3)
}
fn reason(text: &str) -> String {
    IesProfile::from_text(text).unwrap_err().to_string()
}

#[test]
fn factors_multiply() {
    // Multiplier 2, ballast factor 0.5.
    assert!((at(PLAIN, 0.0) - 4.0).abs() < 1e-6 && (at(PLAIN, 67.5) - 1.0).abs() < 1e-5);
    let with = |header: &str| PLAIN.replace("IESNA:LM-63-1995", header).replace("0.5 1 20", "0.5 1.1 20");
    assert!((at(&with("IESNA91"), 0.0) - 4.4).abs() < 1e-5);
    // There the second factor is the kind of file.
    assert!((at(&with("IES:LM-63-2019"), 0.0) - 4.0).abs() < 1e-6);
}

#[test]
fn every_version_and_layout_is_read() {
    let body = &PLAIN[PLAIN.find("TILT").unwrap()..];
    let include = body.replace("TILT=NONE\n", "TILT=INCLUDE\n1\n3\n0 45 90\n1 0.9\n0.8\n");
    let forms = [
        format!("an old file without a first line of its own\n{body}"),
        format!("IESNA91\n[MANUFAC]\n{body}"),
        format!("IESNA:LM-63-2002\n[MORE] TILT=?\n{}", body.replace('\n', "\r\n")),
        body.replace('\n', "\r"),
        body.replace("0 45 90", "0,45 ,\n 90"),
        body.replace("TILT=NONE", "  tilt=none "),
        body.replace("TILT=NONE", "TILT=other.tlt"),
        format!("IESNA:LM-63-2002\n{include}"),
        format!("\u{feff}{body}\u{1a}"),
        body.replace("4 2 0", "4e0 +2.0 -0.5"),
    ];
    for text in &forms {
        let got = IesProfile::from_text(text);
        assert!(got.is_ok_and(|p| (p.intensity(0.0, 0.0) - 4.0).abs() < 1e-6), "{text}");
    }
    let latin1 = std::env::temp_dir().join(format!("umber-latin1-{}.ies", std::process::id()));
    let bytes = [b"IESNA:LM-63-2002\n[MANUFAC] Leuchtenf\xe4brik\n".as_slice(), body.as_bytes()].concat();
    std::fs::write(&latin1, bytes).unwrap();
    assert!(IesProfile::load(&latin1).is_ok());
    std::fs::remove_file(latin1).unwrap();
}

#[test]
fn broken_files_say_what_is_wrong() {
    let with = |from: &str, to: &str| {
        assert!(PLAIN.contains(from));
        reason(&PLAIN.replace(from, to))
    };
    for (got, want) in [
        (reason(""), "TILT"),
        (reason("TILT=NONE"), "ends before the number of lamps"),
        (with("4 2 0\n", "4 2"), "ends before a candela value"),
        (with("45", "x45"), "a vertical angle: 'x45' is not a number"),
        (with("4 2 0", "4 nan 0"), "'nan' is not a finite number"),
        (with("4 2 0", "4 inf 0"), "'inf' is not a finite number"),
        (with("2 3 1 1", "2 3 1 2"), "type B"),
        (with("2 3 1 1", "2 3 1 3"), "type A"),
        (with("2 3 1 1", "2 3 1 7"), "photometric type 7"),
        (with("2 3 1 1", "2 -3 1 1"), "number of vertical angles"),
        (with("2 3 1 1", "2 3.5 1 1"), "number of vertical angles"),
        (with("2 3 1 1", "2 9999999999 1 1"), "number of vertical angles"),
        (with("2 3 1 1", "2 9999999 9999999 1"), "make no profile"),
        (with("2 3 1 1", "2 1 1 1"), "make no profile"),
        (with("2 3 1 1", "2 3 0 1"), "make no profile"),
        (with("0 45 90", "0 90 45"), "ascend"),
        (with("0 45 90", "-90 0 90"), "vertical angles"),
        (with("0 45 90", "0 45 200"), "vertical angles"),
        (
            with("2 3 1 1 2 0.1 0.1 0\n0.5 1 20\n0 45 90\n0\n", "2 2 2 1 2 0 0 0\n1 1 9\n0 90\n0 45\n7 "),
            "horizontal angles",
        ),
        (with("TILT=NONE", "TILT=INCLUDE\n1\n99999"), "ends before"),
    ] {
        assert!(got.contains(want) && got.contains("(text)"), "{got}; not {want}");
    }
    let missing = IesProfile::load("/nowhere/lamp.ies").unwrap_err();
    assert!(matches!(missing, IesError::Io { .. }) && missing.to_string().contains("/nowhere/lamp.ies"));
    // Any part of a file, and any byte of it wrong, gives a profile or an error.
    for end in 0..PLAIN.len() {
        let _ = IesProfile::from_text(&PLAIN[..end]);
        for c in ['0', '9', '-', 'e', ' ', '\n', 'é'] {
            let mut text: String = PLAIN[..end].into();
            text.push(c);
            text.push_str(&PLAIN[end + 1..]);
            if let Ok(profile) = IesProfile::from_text(&text) {
                for v in [-1.0, 0.0, 1.0, 3.2, f32::NAN, f32::INFINITY] {
                    let i = profile.intensity(v, v);
                    assert!(i.is_finite() && i >= 0.0 && profile.mean().is_finite(), "{text}: {i}");
                }
            }
        }
    }
}

/// The files of the UsdLux test suite, where they lie beside the checkout.
#[test]
fn the_test_suites_profiles_are_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/assets/luxtest");
    if !folder.exists() {
        return;
    }
    let load = |name: &str| IesProfile::load(folder.join(name)).unwrap();
    let at = |p: &IesProfile, v: f32, h: f32| p.intensity(v.to_radians(), h.to_radians());
    let close = |got: f32, want: f32| (got - want).abs() < 1e-3 * want.max(1e-2);
    let bega = load("04f377f94ce81cd7b5101fffdf571454.ies");
    for (v, want) in [(0.0, 3154.6), (2.5, 3078.8), (20.0, 1410.0), (21.25, 1330.5), (90.0, 0.0), (95.0, 0.0)] {
        assert!(close(at(&bega, v, 77.0), want), "{v}°: {}", at(&bega, v, 77.0));
    }
    // 1861 lm come out of it, by its own header.
    assert!((bega.mean() * 2.0 * std::f32::consts::PI / 1861.0 - 1.0).abs() < 0.02, "{}", bega.mean());
    let linear = load("test_linear_vertical.ies");
    assert!(close(at(&linear, 45.0, 0.0), 0.75) && close(linear.mean(), 0.5));
    let (even, uneven) = (load("test_stripes_uniform.ies"), load("test_stripes_nonuniform.ies"));
    for v in (0..180).map(|v| v as f32 + 0.5) {
        assert!(close(at(&even, v, 9.0), at(&uneven, v, 9.0)), "{v}°");
    }
    let quadrants = load("test_vstripes_hquadrants_nonuniform.ies");
    // Black stripes are lighter in every other quadrant; in the last two, black and white are swapped.
    for (h, at_15, at_25) in [(45.0, 1.0, 0.0), (135.0, 1.0, 0.25), (225.0, 0.0, 1.0), (315.0, 0.25, 1.0)] {
        assert!(close(at(&quadrants, 15.0, h), at_15), "{h}°: {}", at(&quadrants, 15.0, h));
        assert!(close(at(&quadrants, 25.0, h), at_25), "{h}°: {}", at(&quadrants, 25.0, h));
    }
    let (down, up) = (
        load("test_vstripes_hquadrants_nonuniform_aimDown.ies"),
        load("test_vstripes_hquadrants_nonuniform_aimUp.ies"),
    );
    assert!(at(&down, 7.0, 10.0) == 1.0 && at(&down, 60.0, 10.0) == 0.0);
    assert!(at(&up, 137.0, 10.0) == 1.0 && at(&up, 60.0, 10.0) == 0.0);
}
