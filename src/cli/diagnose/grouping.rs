//! Which pictures belong together, by the names of their files.

use super::args::Grouping;
use crate::cli::base::{Failure, usage};
use fredholm::engine::MOST_BOUNCES;
use std::path::PathBuf;

/// The common beginning of the file names, and the number at the end of each; `None` if they have neither.
fn numbered(paths: &[PathBuf]) -> Option<(String, Vec<u32>)> {
    let split = |p: &PathBuf| {
        let stem = p.file_stem()?.to_string_lossy().into_owned();
        let stem = stem.trim_end_matches("spp").trim_end_matches(['_', '-']).to_owned();
        let word = stem.trim_end_matches(|c: char| c.is_ascii_digit());
        Some((word.to_owned(), stem[word.len()..].parse::<u32>().ok()?))
    };
    let all: Option<Vec<(String, u32)>> = paths.iter().map(split).collect();
    let all = all?;
    let word = all.first()?.0.clone();
    all.iter().all(|a| a.0 == word).then(|| (word, all.iter().map(|a| a.1).collect()))
}

/// How the files belong together, with the number of each file.
pub fn grouping(asked: Grouping, paths: &[PathBuf]) -> Result<(Grouping, Vec<u32>), Failure> {
    let found = numbered(paths);
    let need = || {
        let help = "name them like T00.exr, T01.exr, … or render_16.exr, render_64.exr, …";
        Failure::Usage(format!("error: these files do not end in numbers after one common name\nhelp: {help}"))
    };
    match asked {
        Grouping::Separate => Ok((Grouping::Separate, vec![])),
        Grouping::Bounces | Grouping::Spp => {
            let numbers = found.ok_or_else(need)?.1;
            let most = u32::from(MOST_BOUNCES);
            match numbers.iter().find(|&&k| asked == Grouping::Bounces && k > most) {
                Some(k) => {
                    Err(usage(&format!("{k} is not the number of a term: K is at most {most}"), "rename the files"))
                }
                None => Ok((asked, numbers)),
            }
        }
        Grouping::Auto => {
            let Some((_, numbers)) = found.filter(|_| paths.len() > 1) else { return Ok((Grouping::Separate, vec![])) };
            let mut sorted = numbers.clone();
            sorted.sort_unstable();
            let steps = |ok: &dyn Fn(u32, u32) -> bool| sorted.windows(2).all(|w| ok(w[0], w[1]));
            if sorted[0] <= 1 && steps(&|a, b| b == a + 1) && (sorted[0] == 0 || sorted.len() > 2) {
                Ok((Grouping::Bounces, numbers))
            } else if sorted[0] > 0 && steps(&|a, b| 2 * b >= 3 * a) {
                Ok((Grouping::Spp, numbers))
            } else {
                Ok((Grouping::Separate, vec![]))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn files_are_grouped_by_their_names() {
        let of = |names: &[&str]| {
            grouping(Grouping::Auto, &names.iter().map(PathBuf::from).collect::<Vec<_>>()).ok().unwrap().0
        };
        assert_eq!(of(&["a/T00.exr", "a/T01.exr"]), Grouping::Bounces);
        assert_eq!(of(&["r_1.exr", "r_2.exr", "r_3.exr"]), Grouping::Bounces);
        assert_eq!(of(&["r_16spp.png", "r_4spp.png", "r_64spp.png"]), Grouping::Spp);
        assert_eq!(of(&["double-emission.exr", "clamped.exr"]), Grouping::Separate);
        assert_eq!(of(&["T00.exr"]), Grouping::Separate);
        assert_eq!(of(&["scene7.exr", "scene8.exr"]), Grouping::Separate);
    }
}
