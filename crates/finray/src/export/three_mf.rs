//! 3MF, the zip of the 3MF Core Specification 1.3: a mesh with its unit and name.

use super::prism::Prism;
use maud::html;
use std::io::{Cursor, Write};
use zip::CompressionMethod;
use zip::result::ZipResult;
use zip::write::{SimpleFileOptions, ZipWriter};

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;

const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rel-1" Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

/// The surface as a 3MF file, mm.
///
/// # Errors
/// If the zip cannot be written.
pub fn write(prism: &Prism, title: &str) -> ZipResult<Vec<u8>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let parts = [
        ("[Content_Types].xml", TYPES),
        ("_rels/.rels", RELATIONS),
        ("3D/3dmodel.model", &model(prism, title)),
    ];
    // No clock: the entries carry the format's first date.
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, text) in parts {
        zip.start_file(name, options)?;
        zip.write_all(text.as_bytes())?;
    }
    Ok(zip.finish()?.into_inner())
}

fn model(prism: &Prism, title: &str) -> String {
    let declaration = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    let model = html! {
        model unit="millimeter" xml:lang="en-US"
            xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" {
            metadata name="Title" { (title) }
            metadata name="Application" { "finger-opt " (env!("CARGO_PKG_VERSION")) }
            resources {
                object id="1" type="model" name=(title) {
                    mesh {
                        vertices {
                            @for [x, y, z] in &prism.corners { vertex x=(x) y=(y) z=(z) {} }
                        }
                        triangles {
                            @for [a, b, c] in &prism.triangles { triangle v1=(a) v2=(b) v3=(c) {} }
                        }
                    }
                }
            }
            build { item objectid="1" {} }
        }
    };
    declaration.to_owned() + &model.into_string()
}
