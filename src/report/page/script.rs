//! The scripts of the page: plain ES modules, which a browser can load from one file on disk.
//!
//! A page that is opened from disk may not import a module from another file. So the page contains the source of each module as
//! text. The loader makes an address for each of them and tells the browser by an import map which module has which address.
//! No module is changed or joined with another one, so a reader of the page's source sees them as they are in `script/`.

use std::fmt::Write;

/// The modules by the name that others import.
pub const MODULES: [(&str, &str); 24] = [
    ("types", include_str!("script/types.js")),
    ("decode", include_str!("script/decode.js")),
    ("run", include_str!("script/run.js")),
    ("statistics", include_str!("script/statistics.js")),
    ("format", include_str!("script/format.js")),
    ("state", include_str!("script/state.js")),
    ("scale", include_str!("script/scale.js")),
    ("compose", include_str!("script/compose.js")),
    ("tone", include_str!("script/tone.js")),
    ("gains", include_str!("script/gains.js")),
    ("viewer", include_str!("script/viewer.js")),
    ("controls", include_str!("script/controls.js")),
    ("reading", include_str!("script/reading.js")),
    ("what_if", include_str!("script/what_if.js")),
    ("chart", include_str!("script/chart.js")),
    ("probe", include_str!("script/probe.js")),
    ("plots", include_str!("script/plots.js")),
    ("samples", include_str!("script/samples.js")),
    ("exr", include_str!("script/exr.js")),
    ("own", include_str!("script/own.js")),
    ("keys", include_str!("script/keys.js")),
    ("tries", include_str!("script/tries.js")),
    ("share", include_str!("script/share.js")),
    ("main", include_str!("script/main.js")),
];

const LOADER: &str = include_str!("script/loader.js");

/// The elements of the page that hold the modules, and the loader.
pub fn elements() -> String {
    let mut out = String::new();
    for (name, source) in MODULES {
        // writing to a string cannot fail
        let _ = write!(out, "<script type=\"text/plain\" data-module=\"#page/{name}.js\">\n{source}</script>\n");
    }
    let _ = write!(out, "<script>\n{LOADER}</script>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_import_is_a_module_and_no_source_ends_its_element() {
        for (name, source) in MODULES.into_iter().chain([("loader", LOADER)]) {
            assert!(!source.contains("</script") && !source.contains("<!--"), "{name}");
            assert!(source.lines().count() < 400, "{name} has {} lines", source.lines().count());
            for import in source.split("from '").skip(1).filter_map(|rest| rest.split('\'').next()) {
                let known = |(name, _): (&str, &str)| import == format!("#page/{name}.js");
                assert!(MODULES.into_iter().any(known), "{name} imports {import}");
            }
        }
    }

    #[test]
    fn every_file_of_the_folder_is_a_module() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/report/page/script");
        let files = std::fs::read_dir(folder).expect("the folder is there").filter_map(Result::ok);
        let names = files.filter_map(|f| f.file_name().into_string().ok()).filter(|n| n.ends_with(".js"));
        assert_eq!(names.count(), MODULES.len() + 1);
    }
}
