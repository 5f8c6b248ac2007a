//! Checks of an OBJ file that report the line: wrong numbers, indices out of range, and faces with too few corners.

use super::{
    cursor::{LARGEST_LENGTH, LARGEST_UV},
    mtl::Statement,
    names,
};
use crate::scene::SceneError;
use std::path::Path;

/// The integer index in a corner of a face.
pub(super) fn number_of(word: &str) -> Option<i64> {
    word.parse().ok()
}

/// Returns an error for the first malformed statement, with its line.
pub(super) fn check(list: &[Statement], path: &Path) -> Result<(), SceneError> {
    let count = |key: &str| list.iter().filter(|s| s.key == key).count() as i64;
    let (total, total_vt) = (count("v"), count("vt"));
    let (mut seen, mut seen_vt) = (0, 0);
    for s in list {
        if let Some(kind) = [("o", "object"), ("g", "group"), ("usemtl", "material")].into_iter().find(|k| k.0 == s.key)
        {
            let unfit = |f: names::Fault| SceneError::new(f.what).at(path, s.line).key(s.key.clone()).help(f.help);
            names::check(&s.rest, kind.1).map_err(unfit)?;
        }
        let fail = |what: String, help: &str| Err(SceneError::new(what).at(path, s.line).key(s.key.clone()).help(help));
        match &*s.key {
            "v" => {
                seen += 1;
                let mut numbers = [0.0; 3];
                let mut words = s.words();
                if !numbers.iter_mut().all(|x| words.next().and_then(|w| w.parse().ok()).map(|y: f64| *x = y).is_some())
                {
                    return fail(format!("`{}` is not a position", s.rest), "a vertex is three numbers");
                }
                if numbers.iter().any(|x| x.is_nan() || x.abs() > LARGEST_LENGTH) {
                    return fail(
                        format!("the vertex {} is not finite or exceeds 1e12", s.rest),
                        "correct the numbers in the file",
                    );
                }
            }
            "vt" => {
                seen_vt += 1;
                let numbers = s.words().take(2).map(str::parse).collect::<Result<Vec<f64>, _>>().unwrap_or_default();
                if numbers.is_empty() || numbers.iter().any(|x| x.is_nan() || x.abs() > LARGEST_UV) {
                    let help = "write vt u v, within 1e5 repeats of the image";
                    return fail(format!("`{}` is not a texture coordinate", s.rest), help);
                }
            }
            "f" => {
                if s.words().count() < 3 {
                    return fail(
                        format!("the face `{}` has fewer than 3 corners", s.rest),
                        "a face is three indices or more",
                    );
                }
                for word in s.words() {
                    let mut parts = word.split('/');
                    let first = parts.next().unwrap_or("");
                    let rest = || parts.clone();
                    let rest_valid = rest().count() <= 2 && rest().all(|p| p.is_empty() || number_of(p).is_some());
                    let Some(i) = number_of(first).filter(|_| rest_valid) else {
                        return fail(format!("`{word}` is not a corner"), "write v, v/vt, v//vn or v/vt/vn");
                    };
                    if i == 0 || i > total || (i < 0 && seen < i.saturating_neg()) {
                        let what = format!("vertex index {i} is out of range, the file has {total} vertices");
                        return fail(what, "indices start at 1; negative ones count back from the last vertex");
                    }
                    let vt = rest().next().and_then(number_of);
                    if let Some(i) = vt.filter(|&i| i == 0 || i > total_vt || (i < 0 && seen_vt < i.saturating_neg())) {
                        let what = format!("vt index {i} is out of range, the file has {total_vt}");
                        return fail(
                            what,
                            "use an index from 1 to the number of vt lines; negative indices count back from the last vt line",
                        );
                    }
                }
            }
            "usemtl" if s.rest.is_empty() => return fail("usemtl needs a name".into(), "write usemtl NAME"),
            _ => {}
        }
    }
    Ok(())
}
