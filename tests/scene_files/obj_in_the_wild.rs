//! OBJ files as people have them: concave polygons, files of other systems, keys of other programs, faults that matter nothing.

use super::*;

/// An OBJ file with its MTL in a folder of their own; returns the scene and the folder.
fn pair(obj: &[u8], mtl: &[u8]) -> (Result<Loaded, fredholm::scene::SceneError>, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.mtl"), mtl).unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, obj).unwrap();
    (scene(path.to_str().unwrap(), &Options::default()), folder)
}

fn warnings(obj: &str, mtl: &str) -> Vec<String> {
    let (loaded, _folder) = pair(obj.as_bytes(), mtl.as_bytes());
    loaded.unwrap().warnings
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
const LAMP: &str = "newmtl a\nKe 1 1 1\nKd 0.5 0.5 0.5\n";

/// The sum of the areas of all triangles.
fn area(loaded: &Loaded) -> f64 {
    let of = |geometry: &Geometry| {
        let Geometry::Mesh { vertices, faces, .. } = geometry else { panic!("no mesh") };
        let corners = faces.iter().map(|f| f.map(|i| vertices[i as usize]));
        corners.map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum::<f64>()
    };
    loaded.description.shapes.iter().map(|s| of(&s.geometry)).sum()
}

/// The dart has its reflex corner at 3: as 2 3 4 1 the fan from its first corner would overlap itself.
#[test]
fn concave_polygons_have_their_area() {
    for face in ["1 2 3 4", "2 3 4 1", "3 4 1 2", "4 1 2 3", "4 3 2 1"] {
        let obj = format!("mtllib m.mtl\nv 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nusemtl a\nf {face}\n");
        let (loaded, _folder) = pair(obj.as_bytes(), LAMP.as_bytes());
        let loaded = loaded.unwrap();
        assert_eq!(loaded.warnings, Vec::<String>::new(), "{face}");
        assert!((area(&loaded) - 4.0).abs() < 1e-6, "{face}");
    }
    let bow = "mtllib m.mtl\nv 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\nusemtl a\nf 1 2 3 4\n";
    assert!(warnings(bow, LAMP)[0].contains("polygons that cross themselves: 1"));
}

/// The same scene in the encodings and line ends of other systems.
#[test]
fn files_of_other_systems_are_read() {
    let obj = format!("# a comment\nmtllib m.mtl\n{TRIANGLE}");
    let wanted = pair(obj.as_bytes(), LAMP.as_bytes()).0.unwrap();
    let wide = |text: &str, little: bool| -> Vec<u8> {
        let units = std::iter::once(0xfeff).chain(text.encode_utf16());
        units.flat_map(|u| if little { u.to_le_bytes() } else { u.to_be_bytes() }).collect()
    };
    let forms: [fn(&str) -> Vec<u8>; 4] = [
        |t| t.replace('\n', "\r").into_bytes(),
        |t| t.replace('\n', "\r\n").into_bytes(),
        |t| format!("\u{feff}{t}").into_bytes(),
        |t| t.replace('\n', "\r\r\n").into_bytes(),
    ];
    let mut all: Vec<[Vec<u8>; 2]> = forms.iter().map(|f| [f(&obj), f(LAMP)]).collect();
    all.extend([true, false].map(|little| [wide(&obj, little), wide(LAMP, little)]));
    for (i, [obj, mtl]) in all.iter().enumerate() {
        let found = pair(obj, mtl).0.unwrap();
        assert_eq!((found.canonical, found.warnings), (wanted.canonical.clone(), vec![]), "form {i}");
    }
    // names as written on Windows
    for name in [".\\m.mtl", "./m.mtl", "sub\\..\\m.mtl"] {
        let obj = format!("mtllib {name}\n{TRIANGLE}");
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("sub")).unwrap();
        std::fs::write(folder.path().join("m.mtl"), LAMP).unwrap();
        std::fs::write(folder.path().join("a.obj"), obj).unwrap();
        let found = scene(folder.path().join("a.obj").to_str().unwrap(), &Options::default()).unwrap();
        assert_eq!(found.canonical, wanted.canonical, "{name}");
    }
    let (e, folder) = pair(format!("mtllib C:\\models\\m2.mtl\n{TRIANGLE}").as_bytes(), LAMP.as_bytes());
    let e = e.unwrap_err().to_string();
    assert!(e.contains("C:\\models\\m2.mtl") && e.contains(folder.path().to_str().unwrap()), "{e}");
}

#[test]
fn what_is_dropped_is_listed() {
    let said = warnings(&format!("mtllib m.mtl\n{TRIANGLE}fo 1 2 3\nfo 1 2 3\ncstype bezier\nnonsense 1\n"), LAMP);
    let has = |what: &str| assert!(said.iter().any(|w| w.ends_with(what)), "{what}: {said:?}");
    has(":7: the statement `fo` is ignored (2 times); write f for faces");
    has(":9: the statement `cstype` is ignored");
    has(":10: the statement `nonsense` is ignored");
    let keys = "Pr 0.3\nPm 1\nPs 0.1\nPc 0.2\nPcr 0.1\naniso 0.1\nmap_Pr r.png\nmap_Ke e.png\nmap_kd d.png\nrefl -type sphere s.png\nkd 0.1 0.1 0.1\n";
    let said = warnings(&format!("mtllib m.mtl\n{TRIANGLE}"), &format!("{LAMP}{keys}"));
    assert_eq!(said.len(), 1, "{said:?}");
    for key in keys.lines().map(|l| l.split(' ').next().unwrap()) {
        assert!(said[0].contains(&format!(" {key} ")), "{key}: {said:?}");
    }
    assert!(said[0].contains("map_kd d.png (did you mean map_Kd?)") && said[0].contains("(did you mean Kd?)"));
    // statements that change no image are not worth a word
    let quiet = format!("mtllib m.mtl\ns 1\nvn 0 0 1\nvp 0 0\n{TRIANGLE}l 1 2\np 1\n");
    assert_eq!(warnings(&quiet, &format!("{LAMP}sharpness 60\nKm 0\n")), Vec::<String>::new());
}

#[test]
fn a_fault_that_nothing_uses_is_a_warning() {
    let bad = "newmtl b\nKd 0.5 nonsense 0.5\nd 7\n";
    let obj = format!("mtllib m.mtl\n{TRIANGLE}");
    let said = warnings(&obj, &format!("{LAMP}{bad}"));
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].contains("`b`, which nothing uses") && said[0].contains("m.mtl:5"), "{said:?}");
    let e = pair(obj.replace("usemtl a", "usemtl b").as_bytes(), format!("{LAMP}{bad}").as_bytes()).0.unwrap_err();
    assert_eq!((e.line, e.key.as_deref()), (Some(5), Some("b.Kd")), "{e}");
}

#[test]
fn sums_are_printed_without_their_rounding() {
    let said =
        warnings(&format!("mtllib m.mtl\n{TRIANGLE}"), &format!("{LAMP}Kd 0.7 0.7 0.7\nKs 0.44 0.44 0.44\nNs 10\n"));
    assert!(said.iter().any(|w| w.contains("1.14,")), "{said:?}");
}

#[test]
fn names_cannot_command_a_terminal() {
    for name in ["red\u{1b}[31m", "a\u{7}b", "gnp.\u{202e}exe", "\u{9b}2J"] {
        for line in ["usemtl", "o", "g"] {
            let obj = format!("mtllib m.mtl\n{line} {name}\n{TRIANGLE}");
            let e = pair(obj.as_bytes(), LAMP.as_bytes()).0.unwrap_err();
            assert_eq!(e.line, Some(2), "{line} {name:?}");
            assert!(!e.to_string().chars().any(|c| c != '\n' && (c.is_control() || c == '\u{202e}')), "{e}");
        }
        let e =
            pair(format!("mtllib m.mtl\n{TRIANGLE}").as_bytes(), format!("newmtl {name}\n").as_bytes()).0.unwrap_err();
        assert_eq!(e.line, Some(1));
    }
}
