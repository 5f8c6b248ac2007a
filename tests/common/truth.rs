//! Values known in closed form, or to many digits by an independent method: the files of `tests/truth/`. Each case says
//! in `how_verified` where its numbers come from, and in `digits` how many decimals may be trusted.

use serde_json::Value;
use std::{fs, path::Path};

/// One case.
pub struct Case(Value);

/// The case `id` of `tests/truth/<file>.json`.
pub fn case(file: &str, id: &str) -> Case {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/truth/{file}.json"));
    let all: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    let found = all.as_array().unwrap().iter().find(|c| c["id"] == id);
    Case(found.unwrap_or_else(|| panic!("no case `{id}` in {}", path.display())).clone())
}

fn numbers(v: &Value) -> Vec<f64> {
    v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

impl Case {
    fn get(&self, key: &str) -> &Value {
        let v = if self.0["expected"][key].is_null() { &self.0["inputs"][key] } else { &self.0["expected"][key] };
        assert!(!v.is_null(), "case {} has no `{key}`", self.0["id"]);
        v
    }

    /// A number of `expected` or `inputs`.
    pub fn number(&self, key: &str) -> f64 {
        self.get(key).as_f64().unwrap()
    }

    /// A list of numbers.
    pub fn list(&self, key: &str) -> Vec<f64> {
        numbers(self.get(key))
    }

    /// A list of lists: usually `terms[k][region]`.
    pub fn table(&self, key: &str) -> Vec<Vec<f64>> {
        self.get(key).as_array().unwrap().iter().map(numbers).collect()
    }

    /// Lists of lists of lists: `terms[k][part][channel]`.
    pub fn tables(&self, key: &str) -> Vec<Vec<Vec<f64>>> {
        let tables = self.get(key).as_array().unwrap().iter();
        tables.map(|t| t.as_array().unwrap().iter().map(numbers).collect()).collect()
    }

    /// A list of whatever the case holds.
    pub fn rows(&self, key: &str) -> Vec<Value> {
        self.get(key).as_array().unwrap().clone()
    }
}
