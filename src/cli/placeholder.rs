//! Stands in for tasks and robots until their files are merged.

use serde::Deserialize;

/// Stands in for a task or a robot: what `optimize tasks` shows of either.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Head {
    pub name: String,
    pub description: String,
}

impl Head {
    pub fn parse(text: &str, file: &str) -> Result<Self, String> {
        toml::from_str(text).map_err(|error| format!("{file}: {}", error.to_string().trim_end()))
    }
}
