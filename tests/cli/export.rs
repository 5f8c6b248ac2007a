//! `fredholm export`: files for other renderers, what has no counterpart, and what is never replaced.

use super::*;
use fredholm::scene::builtin;
use fredholm::scene::description::Geometry;
use fredholm::scene::export::{Renderer, Settings, export};
use fredholm::scene::load::{self, Options};

fn settings() -> Settings {
    Settings { max_bounces: Some(8), spp: 16, stem: "scene".into() }
}

/// Names of the elements of an XML file that are open at its end; every `<a …/>` closes itself.
fn open_elements(xml: &str) -> Vec<String> {
    let mut open: Vec<String> = vec![];
    for tag in xml.split('<').skip(1).map(|t| t.split('>').next().unwrap()) {
        let name = |t: &str| t.split_whitespace().next().unwrap_or("").trim_matches('/').to_owned();
        match tag {
            t if t.starts_with(['?', '!']) || t.ends_with('/') => {}
            t if t.starts_with('/') => assert_eq!(open.pop().as_deref(), Some(&t[1..]), "{tag}"),
            t => open.push(name(t)),
        }
    }
    open
}

#[test]
fn every_shipped_scene_is_exported_or_says_what_is_not() {
    let reasons = |name: &str, to| match (name, to) {
        ("env-ggx" | "veach-ajar" | "veach-mis", Renderer::Mitsuba) => Some("masking"),
        ("veach-mis", Renderer::Pbrt) => Some("reflectance"),
        ("sphere" | "sky-bowl", Renderer::Mitsuba) => Some("band"),
        _ => None,
    };
    for scene in builtin::ALL {
        let d = load::scene(scene.name, &Options::default()).unwrap().description;
        for to in [Renderer::Mitsuba, Renderer::Pbrt] {
            match export(&d, to, &settings()) {
                Err(e) => {
                    let reason =
                        reasons(scene.name, to).unwrap_or_else(|| panic!("{} for {to:?}: {}", scene.name, e.what));
                    assert!(e.what.contains(reason) && !e.help.is_empty(), "{}: {}", scene.name, e.what);
                }
                Ok(file) if to == Renderer::Mitsuba => {
                    assert_eq!(open_elements(&file.text), Vec::<String>::new(), "{}", scene.name);
                    assert_eq!(file.text.matches("<shape ").count(), d.shapes.len(), "{}", scene.name);
                    let lamps = d.shapes.iter().filter(|s| s.emission != glam::DVec3::ZERO).count();
                    assert_eq!(file.text.matches("<emitter type=\"area\"").count(), lamps, "{}", scene.name);
                    for (name, obj) in &file.beside {
                        assert!(file.text.contains(name.as_str()) && obj.starts_with("v "), "{name}");
                    }
                }
                Ok(file) => {
                    assert_eq!(file.text.matches("AttributeBegin").count(), d.shapes.len(), "{}", scene.name);
                    assert_eq!(file.text.matches('[').count(), file.text.matches(']').count(), "{}", scene.name);
                }
            }
        }
    }
}

/// The corners of the unit square of Mitsuba, through the matrix that is written, are the corners of the parallelogram.
#[test]
fn rectangles_lie_where_their_quads_do() {
    let d = load::scene("cornell", &Options::default()).unwrap().description;
    let text = export(&d, Renderer::Mitsuba, &settings()).unwrap().text;
    let matrices: Vec<Vec<f64>> = text
        .split("matrix value=\"")
        .skip(1)
        .map(|m| m.split('"').next().unwrap().split(' ').map(|v| v.parse().unwrap()).collect())
        .collect();
    let quads: Vec<[glam::DVec3; 3]> = d
        .shapes
        .iter()
        .filter_map(|s| match &s.geometry {
            Geometry::Quad { origin, edge_u, edge_v } => Some([*origin, *edge_u, *edge_v]),
            _ => None,
        })
        .collect();
    assert_eq!(matrices.len(), quads.len());
    for (m, [origin, u, v]) in matrices.iter().zip(quads) {
        let at = |x: f64, y: f64| glam::DVec3::from_array([0, 4, 8].map(|r| m[r] * x + m[r + 1] * y + m[r + 3]));
        for (x, y, corner) in [(-1.0, -1.0, origin), (1.0, -1.0, origin + u), (-1.0, 1.0, origin + v)] {
            assert!((at(x, y) - corner).length() < 1e-12);
        }
        let normal = glam::DVec3::from_array([2, 6, 10].map(|i| m[i]));
        assert!((normal - u.cross(v).normalize()).length() < 1e-12);
    }
}

/// What Mitsuba models differently is noted where the scene shows it, and nowhere else.
#[test]
fn only_materials_of_the_scene_are_noted() {
    let of = |set: &[&str]| {
        let masked = ["plastic", "gold02", "gold08", "copper20", "copper50"]
            .map(|m| format!("materials.{m}.masking=\"separable\""));
        let set = masked.into_iter().chain(set.iter().map(|s| String::from(*s))).collect();
        let d = load::scene("env-ggx", &Options { set, ..Options::default() }).unwrap().description;
        export(&d, Renderer::Mitsuba, &settings()).unwrap().notes
    };
    assert!(matches!(&of(&[])[..], [note] if note.contains("`plastic`")));
    assert_eq!(of(&["shapes[5].material=\"copper50\""]), Vec::<String>::new());
}

#[test]
fn files_are_written_once_and_what_is_missing_is_named() {
    let desk = Desk::new();
    let said = desk.ok("export cornell --to mitsuba --max-bounces 8");
    assert!(said.out.contains("written: cornell.xml") && said.out.contains("OBJ files"), "{}", said.out);
    let text = std::fs::read_to_string(desk.path("cornell.xml")).unwrap();
    assert!(text.contains("\"max_depth\" value=\"9\"") && text.contains("cornell-6.obj"), "{text}");
    assert!(desk.path("cornell-6.obj").is_file() && desk.path("cornell-7.obj").is_file());
    let again = run_tidily(desk.0.path(), "export cornell --to mitsuba");
    assert_eq!(again.code, 3, "{}", again.err);
    assert!(again.err.contains("exists already") && again.err.contains("help: "), "{}", again.err);
    let said = desk.ok("export cornell --to pbrt -o box.pbrt --spp 7");
    assert!(said.err.contains("reflect on both sides"), "{}", said.err);
    assert!(std::fs::read_to_string(desk.path("box.pbrt")).unwrap().contains("\"integer pixelsamples\" [7]"));
    let refused = run_tidily(desk.0.path(), "export env-ggx --to mitsuba");
    assert_eq!(refused.code, 3);
    assert!(refused.err.contains("masking") && refused.err.contains("--set materials."), "{}", refused.err);
    assert!(!desk.path("env-ggx.xml").exists());
}
