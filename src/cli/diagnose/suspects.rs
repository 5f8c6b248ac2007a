//! The pictures to diagnose: each is a file, or several files that belong together.

use super::args::{Diagnose, Grouping};
use super::grouping::grouping;
use crate::cli::base::{Failure, usage};
use fredholm::diagnosis::picture::{Pictures, Slot};
use fredholm::report::image::foreign::{self, File};
use std::path::{Path, PathBuf};

/// A picture to diagnose.
pub struct Suspect {
    /// Name of the file, or of the first of several.
    pub name: String,
    /// Its layers.
    pub file: File,
    /// The same picture at growing samples per pixel, if there are several.
    pub by_samples: Vec<(u32, Pictures)>,
}

/// The error for pictures that differ in size.
pub fn size_mismatch(name: &str, [a, b]: [usize; 2], [w, h]: [usize; 2]) -> Failure {
    Failure::Input(format!(
        "error: the pictures have different sizes, {a}×{b} and {w}×{h}\n  --> {name}\nhelp: give pictures of one size and one camera"
    ))
}

/// Reads the files of the command line and puts those together that belong together.
pub fn suspects(args: &Diagnose) -> Result<(Vec<Suspect>, Grouping), Failure> {
    let (how, numbers) = grouping(args.grouping, &args.renders)?;
    let files = args.renders.iter().map(|p| foreign::read(p)).collect::<Result<Vec<File>, _>>()?;
    let shown = |p: &Path| p.display().to_string();
    if how != Grouping::Separate
        && let Some((i, file)) = files.iter().enumerate().find(|(_, f)| f.pictures.size != files[0].pictures.size)
    {
        return Err(size_mismatch(&shown(&args.renders[i]), file.pictures.size, files[0].pictures.size));
    }
    let all = match how {
        Grouping::Bounces => {
            let mut layers = vec![];
            let mut first: Option<File> = None;
            for (mut file, k) in files.into_iter().zip(numbers) {
                let mut layer = file.pictures.layers.swap_remove(0);
                layer.slot = Slot::Term(k as usize);
                layers.push(layer);
                first.get_or_insert(file);
            }
            let mut file = first.ok_or_else(|| usage("no file", "name one"))?;
            file.pictures.layers = layers;
            vec![Suspect { name: format!("{} …", shown(&args.renders[0])), file, by_samples: vec![] }]
        }
        Grouping::Spp => {
            let mut by: Vec<(u32, File)> = numbers.into_iter().zip(files).collect();
            by.sort_by_key(|b| b.0);
            let by_samples = by.iter().map(|(n, f)| (*n, f.pictures.clone())).collect();
            let (most, file) = by.pop().ok_or_else(|| usage("no file", "name one"))?;
            vec![Suspect { name: format!("{} … {most} spp", shown(&args.renders[0])), file, by_samples }]
        }
        _ => {
            let one = |(p, file): (&PathBuf, File)| Suspect { name: shown(p), file, by_samples: vec![] };
            args.renders.iter().zip(files).map(one).collect()
        }
    };
    Ok((all, how))
}
