//! The keys and types of `summary.json`: other programs read them, so a change is seen here first. A change that an older reader would
//! misunderstand needs a new `VERSION` of the schema.

use super::*;
use serde_json::Value;

/// The type of every place of a JSON value, as `series[].world: string`. The elements of a list share one place.
fn places(at: &str, value: &Value, found: &mut BTreeMap<String, BTreeSet<&'static str>>) {
    let kind = match value {
        Value::Null => "null",
        Value::Bool(_) => "bool",
        Value::Number(n) if n.is_u64() => "whole",
        Value::Number(_) => "number",
        Value::String(_) => "string",
        Value::Array(_) => "list",
        Value::Object(_) => "table",
    };
    let name = if at.is_empty() { "(file)" } else { at };
    found.entry(name.to_owned()).or_default().insert(kind);
    match value {
        Value::Array(items) => items.iter().for_each(|item| places(&format!("{at}[]"), item, found)),
        Value::Object(entries) => {
            let dot = if at.is_empty() { "" } else { "." };
            entries.iter().for_each(|(key, item)| places(&format!("{at}{dot}{key}"), item, found));
        }
        _ => {}
    }
}

#[test]
fn the_schema_of_summary_json() {
    let desk = Desk::new();
    desk.small("a", "tour cornell --spp 32");
    desk.small("b", "series veach-ajar --spp 4 --worlds terms --technique scatter");
    desk.ok("roulette cornell --size 8x8 --spp 32 --max-bounces 2 -q -o c");
    let mut found = BTreeMap::new();
    for run in ["a", "b", "c"] {
        let text = std::fs::read_to_string(desk.path(run).join("summary.json")).unwrap();
        places("", &serde_json::from_str(&text).unwrap(), &mut found);
    }
    // a float without a fraction is written as 1.0, so a whole number is one by its type
    let line = |(place, kinds): (&String, &BTreeSet<&str>)| {
        format!("{place}: {}", kinds.iter().copied().collect::<Vec<_>>().join(" or "))
    };
    insta::assert_snapshot!(found.iter().map(line).collect::<Vec<_>>().join("\n"));
}
