//! Output of `--repeat` for a window.

use insertion::evaluation::robustness::repeat::{Band, Bands};
use serde_json::{Value, json};

pub fn bands_text(bands: &Bands) -> String {
    let width = |band: &Band| {
        band.width_mm().map_or("more than 2 mm".to_owned(), |width| format!("{width:.1} mm"))
    };
    let inside = match bands.unsure_inside.as_slice() {
        [] => format!("all {} offsets tried insert in every repeat", bands.looked_at_inside),
        unsure => {
            let at: Vec<String> = unsure.iter().map(|mm| format!("{mm:+.1}")).collect();
            let tried = bands.looked_at_inside;
            format!(
                "{} of {tried} offsets tried do not insert in every repeat: {} mm",
                unsure.len(),
                at.join(", ")
            )
        }
    };
    format!(
        "unsure bands  {} below, {} above\nbetween them  {inside}\n",
        width(&bands.negative),
        width(&bands.positive)
    )
}

pub fn bands_json(bands: &Bands) -> Value {
    json!({
        "negative_band_mm": bands.negative.width_mm(),
        "positive_band_mm": bands.positive.width_mm(),
        "offsets_tried_inside": bands.looked_at_inside,
        "unsure_inside_mm": bands.unsure_inside,
    })
}
