//! Fields that a scene file states.

use toml::de::{DeTable, DeValue};

/// Paths of the fields that the text of a scene file states, such as `wind.cells`, without those in lists of sections; empty for a text that is not TOML.
pub fn stated_fields(text: &str) -> Vec<String> {
    let mut paths = Vec::new();
    if let Ok(root) = DeTable::parse(text) {
        collect(root.get_ref(), "", &mut paths);
    }
    paths
}

fn collect(table: &DeTable<'_>, section: &str, paths: &mut Vec<String>) {
    for (key, value) in table {
        let path = if section.is_empty() { key.get_ref().to_string() } else { format!("{section}.{}", key.get_ref()) };
        match value.get_ref() {
            DeValue::Table(table) => collect(table, &path, paths),
            _ => paths.push(path),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stated_fields_have_their_paths() {
        let text = "seed = 1\nwind.sources = 3\n[wind.dust]\nrelease_per_s = 1\n[[lights]]\nat_m = [1, 2, 3]\n[snow]\n";
        let mut fields = stated_fields(text);
        fields.sort();
        assert_eq!(fields, ["lights", "seed", "wind.dust.release_per_s", "wind.sources"]);
        assert!(stated_fields("seed = ").is_empty());
    }
}
