//! Whatever is read, nothing panics.

use super::*;

pub(super) fn runner(cases: u32) -> TestRunner {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    TestRunner::new_with_rng(Config { cases, failure_persistence: None, ..Config::default() }, rng)
}

/// What was read is sound, or refused in words; counts both.
pub(super) fn counted(read: Result<Loaded, SceneError>, good: &Cell<u32>, refused: &Cell<u32>) {
    let count = match read {
        Ok(l) => {
            sound(&l);
            good
        }
        Err(e) => {
            assert!(!e.what.is_empty() && e.help.is_some(), "{e}");
            refused
        }
    };
    count.set(count.get() + 1);
}

/// A change to a text: a splice anywhere, or another value for one of its numbers.
#[derive(Clone, Debug)]
enum Edit {
    Splice { at: prop::sample::Index, cut: usize, put: String },
    Number { which: prop::sample::Index, put: String },
}

/// Up to three changes.
fn edits() -> impl Strategy<Value = Vec<Edit>> {
    #[rustfmt::skip]
    let nasty = prop::sample::select(vec![
        "nan", "-inf", "1e400", "9223372036854775807", "-9223372036854775808", "[", "]]", "0", "-1", "\"", "'''", "= ",
        "[[shapes]]\n", "{}", "\n", "#", "é", "\u{feff}", "\0", "/", "//", "1/1", "f 1 1 1\n", "usemtl ", "mtllib .\n", "\\\n",
    ]);
    let token = prop_oneof!["[ -~\n]{0,6}", nasty.prop_map(str::to_owned)];
    let number = prop_oneof![
        (-4i32..5).prop_map(|i| i.to_string()),
        (-3.0..3.0).prop_map(|x: f64| x.to_string()),
        any::<f64>().prop_map(|x| x.to_string()),
    ];
    let splice = (any::<prop::sample::Index>(), 0usize..12, token);
    let edit = prop_oneof![
        splice.prop_map(|(at, cut, put)| Edit::Splice { at, cut, put }),
        (any::<prop::sample::Index>(), number).prop_map(|(which, put)| Edit::Number { which, put }),
    ];
    prop::collection::vec(edit, 1..4)
}

fn edited(text: &str, edits: &[Edit]) -> String {
    let mut chars: Vec<char> = text.chars().collect();
    for edit in edits {
        match edit {
            Edit::Splice { at, cut, put } => {
                let at = at.index(chars.len() + 1);
                let end = (at + cut).min(chars.len());
                chars.splice(at..end, put.chars());
            }
            Edit::Number { which, put } => {
                let part = |i: usize| chars.get(i).is_some_and(|c| c.is_ascii_digit() || ".-".contains(*c));
                let starts: Vec<usize> = (0..chars.len()).filter(|&i| part(i) && (i == 0 || !part(i - 1))).collect();
                if starts.is_empty() {
                    continue;
                }
                let start = *which.get(&starts);
                let end = (start..).find(|&i| !part(i)).unwrap_or(chars.len());
                chars.splice(start..end, put.chars());
            }
        }
    }
    chars.into_iter().collect()
}

#[test]
fn garbage_in_toml_never_panics() {
    garbage_in_toml(2000);
}

#[test]
#[ignore = "nightly: 10⁵ scene files"]
fn garbage_in_toml_never_panics_in_100_000_cases() {
    garbage_in_toml(100_000);
}

fn garbage_in_toml(cases: u32) {
    let (good, refused) = (Cell::new(0), Cell::new(0));
    let dir = gallery();
    let file = dir.path().join("rich.toml");
    runner(cases)
        .run(&(edits(), any::<bool>()), |(edits, rich)| {
            let text = if rich { RICH } else { GOOD };
            counted(toml(&edited(text, &edits), &file, &Options::default()), &good, &refused);
            Ok(())
        })
        .unwrap();
    let (good, refused) = (good.get(), refused.get());
    assert!(good > 100 && refused > 500, "{good} loaded, {refused} refused: the edits test nothing");
}

#[test]
fn garbage_in_obj_mtl_and_overrides_never_panics() {
    garbage_in_obj(600);
}

#[test]
#[ignore = "nightly: 10⁵ OBJ files"]
fn garbage_in_obj_never_panics_in_100_000_cases() {
    garbage_in_obj(100_000);
}

fn garbage_in_obj(cases: u32) {
    let folder = tempfile::tempdir().unwrap();
    let (obj, mtl) = (folder.path().join("imperfect.obj"), folder.path().join("imperfect.mtl"));
    let (obj_text, mtl_text) =
        ["imperfect.obj", "imperfect.mtl"].map(|f| std::fs::read_to_string(bad(f)).unwrap()).into();
    let good = Cell::new(0);
    runner(cases)
        .run(&(edits(), edits(), edits(), any::<bool>()), |(a, b, c, both)| {
            std::fs::write(&obj, edited(&obj_text, &a)).unwrap();
            std::fs::write(&mtl, if both { edited(&mtl_text, &b) } else { mtl_text.clone() }).unwrap();
            if let Ok(l) = scene(obj.to_str().unwrap(), &Options::default()) {
                sound(&l);
                good.set(good.get() + 1);
            }
            let set = edited("shapes[4].vertices=[[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0]]", &c);
            if let Ok(l) = with(&[&set]) {
                sound(&l);
            }
            Ok(())
        })
        .unwrap();
    let good = good.get();
    assert!(good > 50, "only {good} loaded: the edits test nothing");
}
