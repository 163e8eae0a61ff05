//! Distances between the colours of outcomes, also for readers without green cones.

use super::*;
use crate::theme::variables;
use serde_json::json;

type Vector = [f64; 3];

const TO_XYZ: [Vector; 3] = [
    [0.4124564, 0.3575761, 0.1804375],
    [0.2126729, 0.7151522, 0.0721750],
    [0.0193339, 0.1191920, 0.9503041],
];
/// Deuteranopia in linear sRGB, by Machado, Oliveira and Fernandes (2009).
const DEUTERANOPIA: [Vector; 3] = [
    [0.367322, 0.860646, -0.227968],
    [0.280085, 0.672501, 0.047413],
    [-0.011820, 0.042940, 0.968881],
];
const IDENTITY: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn times(matrix: &[Vector; 3], v: Vector) -> Vector {
    matrix.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum())
}

/// Returns L*, a*, b* (D65) of `#RRGGBB` as seen through a matrix on linear sRGB.
fn lab(hex: &str, seen: &[Vector; 3]) -> Vector {
    let linear = [1, 3, 5].map(|at| {
        let value = f64::from(u8::from_str_radix(&hex[at..at + 2], 16).unwrap()) / 255.0;
        if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
    });
    let seen = times(seen, linear).map(|value| value.clamp(0.0, 1.0));
    let [x, y, z] = times(&TO_XYZ, seen);
    let f = |t: f64| {
        if t > 216.0 / 24389.0 { libm::cbrt(t) } else { (24389.0 / 27.0 * t + 16.0) / 116.0 }
    };
    let [x, y, z] = [f(x / 0.95047), f(y), f(z / 1.08883)];
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// CIEDE2000, symbols of Sharma, Wu and Dalal (2005).
fn ciede2000([l1, a1, b1]: Vector, [l2, a2, b2]: Vector) -> f64 {
    let share = |c: f64| (c.powi(7) / (c.powi(7) + 25f64.powi(7))).sqrt();
    let g = 1.5 - 0.5 * share((libm::hypot(a1, b1) + libm::hypot(a2, b2)) / 2.0);
    let polar =
        |a: f64, b: f64| (libm::hypot(a, b), libm::atan2(b, a).to_degrees().rem_euclid(360.0));
    let ((c1, h1), (c2, h2)) = (polar(g * a1, b1), polar(g * a2, b2));
    let (dl, dc) = (l2 - l1, c2 - c1);
    let dh = (h2 - h1 + 180.0).rem_euclid(360.0) - 180.0;
    let (l, c, h) = ((l1 + l2) / 2.0, (c1 + c2) / 2.0, h1 + dh / 2.0);
    let cos = |degrees: f64| libm::cos(degrees.to_radians());
    let t = 1.0 - 0.17 * cos(h - 30.0) + 0.24 * cos(2.0 * h) + 0.32 * cos(3.0 * h + 6.0)
        - 0.20 * cos(4.0 * h - 63.0);
    let dh = 2.0 * (c1 * c2).sqrt() * libm::sin((dh / 2.0).to_radians());
    let from_blue = (h.rem_euclid(360.0) - 275.0) / 25.0;
    let turn = -2.0 * share(c) * libm::sin((60.0 * libm::exp(-from_blue * from_blue)).to_radians());
    let far = (l - 50.0) * (l - 50.0);
    let [dl, dc, dh] = [
        dl / (1.0 + 0.015 * far / (20.0 + far).sqrt()),
        dc / (1.0 + 0.045 * c),
        dh / (1.0 + 0.015 * c * t),
    ];
    (dl * dl + dc * dc + dh * dh + turn * dc * dh).sqrt()
}

/// Three of the published test pairs.
#[test]
fn the_distance_is_that_of_its_authors() {
    for (one, other, published) in [
        ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
        ([2.0776, 0.0795, -1.1350], [0.9033, -0.0636, -0.5514], 0.9082),
    ] {
        let distance = ciede2000(one, other);
        assert!((distance - published).abs() < 1e-4, "{distance} instead of {published}");
    }
}

#[test]
fn outcomes_differ_in_lightness_and_without_green_cones() {
    for dark in [false, true] {
        let style = variables(dark);
        let hex = COLOURS.map(|(_, colour)| {
            let (_, value) = style.split_once(&format!("--{}:", colour.name())).unwrap();
            value[..7].to_owned()
        });
        let lightness = hex.each_ref().map(|hex| lab(hex, &IDENTITY)[0]);
        for (i, other) in lightness.iter().enumerate().skip(1) {
            assert!(
                (lightness[0] - other).abs() >= 25.0,
                "{} and {}: {lightness:?}",
                hex[0],
                hex[i]
            );
        }
        for (i, one) in hex.iter().enumerate() {
            for other in &hex[i + 1..] {
                let distance = ciede2000(lab(one, &DEUTERANOPIA), lab(other, &DEUTERANOPIA));
                assert!(distance >= 15.0, "{one} and {other}: {distance}");
            }
        }
    }
}

/// Every outcome and a long design; by the estimate of a text's width, which is above that of usual fonts.
#[test]
fn no_entry_of_the_legend_is_cut() {
    let axis = |name| json!({"name": name, "unit": "mm", "low": 0.0, "high": 2.0, "step": 1.0});
    let design = json!({"task.grip.force_n": 1.5, "infill.density_percent": 12.0,
                        "infill.direction_deg": 25.0, "task.strategy.tilt_deg": 5.0});
    let map: CaptureMap = serde_json::from_value(json!({
        "task": "usb", "design": design, "axes": [axis("y"), axis("x")],
        "outcomes": [[0, 1, 2], [3, 4, -1]], "simulated": [[true, true, true], [true, true, true]], "trials": 6,
        "traced_step": 1.0, "area": 1.0, "area_unit": "mm2",
    }))
    .unwrap();
    let svg = svg(&map).unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let texts = document.descendants().filter(|node| node.has_tag_name("text"));
    let texts: Vec<_> = texts
        .map(|node| {
            (node.attribute("x").unwrap().parse::<i32>().unwrap(), node.text().unwrap().trim())
        })
        .collect();
    let last = texts.iter().position(|(_, text)| *text == "simulated").unwrap();
    for (x, text) in &texts[..=last] {
        assert!(x + 8 * text.chars().count() as i32 <= SIZE.0 as i32, "{text} at {x}");
    }
    for entry in ["plug missed (class 2)", "contact loss in insertion (class 4)", "simulated"] {
        assert!(texts.iter().any(|(_, text)| *text == entry), "{entry}: {texts:?}");
    }
}
