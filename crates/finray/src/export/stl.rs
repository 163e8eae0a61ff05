//! STL, binary: what every slicer reads.

use super::prism::Prism;

/// Length of the header, bytes.
const HEADER: usize = 80;

/// The surface as a binary STL file, mm; `title` goes into the header.
pub fn write(prism: &Prism, title: &str) -> Vec<u8> {
    let mut out = format!("finger-opt: {title}; mm").into_bytes();
    out.resize(HEADER, b' ');
    out.extend((prism.triangles.len() as u32).to_le_bytes());
    for triangle in &prism.triangles {
        let [a, b, c] = prism.places(triangle);
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        let corners = triangle.iter().flat_map(|&corner| prism.corners[corner as usize]);
        for value in normal.iter().map(|&n| n as f32).chain(corners) {
            out.extend(value.to_le_bytes());
        }
        out.extend([0, 0]);
    }
    out
}
