//! A line more in a measurement file.

use super::COLUMNS;

/// The file's text with one line more; `cells` are the columns that are not empty. Columns that
/// the file does not have yet are added at its end; a new file has all the documented ones.
pub fn appended(text: &str, cells: &[(&str, String)]) -> Result<String, csv::Error> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let mut header: Vec<String> = match text.trim().is_empty() {
        true => COLUMNS.map(str::to_owned).to_vec(),
        false => reader.headers()?.iter().map(|name| name.trim().to_owned()).collect(),
    };
    let had = header.len();
    for (column, _) in cells {
        if !header.iter().any(|name| name == column) {
            header.push((*column).to_owned());
        }
    }
    let new = header.iter().map(|name| {
        let cell = cells.iter().find(|(column, _)| column == name);
        cell.map_or("", |(_, text)| text.as_str())
    });
    let line = |cells: &mut dyn Iterator<Item = &str>| {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(cells)?;
        let bytes = writer.into_inner().map_err(|error| error.into_error())?;
        Ok::<_, csv::Error>(String::from_utf8_lossy(&bytes).into_owned())
    };
    let last = line(&mut new.into_iter())?;
    // What is there stays as it was written, unless a column is new.
    if had == header.len() && !text.trim().is_empty() {
        let end = if text.ends_with('\n') { "" } else { "\n" };
        return Ok(format!("{text}{end}{last}"));
    }
    let mut whole = line(&mut header.iter().map(String::as_str))?;
    for record in reader.records() {
        let record = record?;
        let more = std::iter::repeat_n("", header.len() - had);
        whole += &line(&mut record.iter().chain(more))?;
    }
    Ok(whole + &last)
}
