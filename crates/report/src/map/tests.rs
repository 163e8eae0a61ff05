//! Layout of title and legend.

use super::*;
use serde_json::json;

/// A map with every outcome and a long design. The width of a text is estimated as that of a font wider than usual.
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
