//! `fredholm export SCENE --to mitsuba|pbrt`: a scene as a file for another renderer.

use super::base::{Ending, Failure, note, print};
use super::open;
use super::options::{Changes, HOW, OUTPUT, WHAT};
use clap::{Args, ValueEnum};
use fredholm::engine::MOST_BOUNCES;
use fredholm::report::text::prose::wrapped;
use fredholm::report::write_atomically;
use fredholm::scene::export::{Renderer, Settings, Unsupported, export};
use std::path::{Path, PathBuf};

/// Below `export --help`.
pub const HELP: &str = "Examples:
  fredholm export cornell --to mitsuba
  fredholm export cornell-spheres --to mitsuba -o spheres.xml
  fredholm export veach-mis --to pbrt --spp 1024 --max-bounces 8

The same scene for Mitsuba 3 (XML, with meshes as OBJ files beside it) or for pbrt-v4. Render it there with a box filter, which the \
file sets, and compare: `fredholm diagnose mine.exr --against SCENE`. What has no counterpart in the other renderer is an error that \
names it.";

/// The other renderer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum To {
    #[value(help = "Mitsuba 3")]
    Mitsuba,
    #[value(help = "pbrt-v4")]
    Pbrt,
}

/// Arguments of `export`.
#[derive(Clone, Debug, Args)]
pub struct Export {
    /// Built-in scene, .toml or .obj
    #[arg(default_value = "cornell", help_heading = WHAT, value_hint = clap::ValueHint::FilePath)]
    pub scene: String,
    /// The renderer: mitsuba or pbrt
    #[arg(long, value_enum, value_name = "RENDERER", help_heading = WHAT)]
    pub to: To,
    /// Changes to the scene.
    #[command(flatten)]
    pub changes: Changes,
    /// Samples per pixel in the file
    #[arg(long, default_value_t = 256, value_name = "N", help_heading = HOW, value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    pub spp: u32,
    /// Largest number of reflections
    ///
    /// [default: all light]
    #[arg(long, value_name = "K", help_heading = HOW, value_parser = clap::value_parser!(u16).range(0..=i64::from(MOST_BOUNCES)))]
    pub max_bounces: Option<u16>,
    /// The file
    ///
    /// It must not exist. [default: the name of the scene, with .xml or .pbrt]
    #[arg(short, long, value_name = "FILE", help_heading = OUTPUT, value_hint = clap::ValueHint::FilePath)]
    pub output: Option<PathBuf>,
}

/// Writes the file, and the meshes beside it.
pub fn run(args: &Export) -> Result<Ending, Failure> {
    let (description, _) = open::description(&args.scene, &args.changes, None)?;
    let (to, ending) = match args.to {
        To::Mitsuba => (Renderer::Mitsuba, "xml"),
        To::Pbrt => (Renderer::Pbrt, "pbrt"),
    };
    let path = args.output.clone().unwrap_or_else(|| format!("{}.{ending}", description.name).into());
    let stem = path.file_stem().map_or_else(|| description.name.clone(), |s| s.to_string_lossy().into_owned());
    let settings = Settings { max_bounces: args.max_bounces.map(usize::from), spp: args.spp, stem };
    let file = export(&description, to, &settings).map_err(|e| unsupported(&args.scene, &e))?;
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside: Vec<(PathBuf, &str)> =
        file.beside.iter().map(|(name, text)| (folder.join(name), text.as_str())).collect();
    let all: Vec<(&Path, &str)> =
        beside.iter().map(|(p, t)| (p.as_path(), *t)).chain([(path.as_path(), file.text.as_str())]).collect();
    if let Some((taken, _)) = all.iter().find(|(p, _)| p.exists()) {
        return Err(Failure::Input(format!(
            "error: the file exists already\n  --> {}\nhelp: name another one with -o, or remove it",
            taken.display()
        )));
    }
    for (path, text) in &all {
        write_atomically(path, text.as_bytes())?;
    }
    file.notes.iter().for_each(|n| note(&format!("note: {n}")));
    let render = match args.to {
        To::Mitsuba => format!("mitsuba {}", path.display()),
        To::Pbrt => format!("pbrt {}", path.display()),
    };
    let meshes = if beside.is_empty() { String::new() } else { format!(", and {} OBJ files beside it", beside.len()) };
    print(&wrapped(&format!(
        "written: {}{meshes}\nRender it with `{render}`, and compare with `fredholm diagnose FILE.exr --against {}`.",
        path.display(),
        args.scene
    )))?;
    Ok(Ending::Ok)
}

fn unsupported(scene: &str, e: &Unsupported) -> Failure {
    Failure::Input(format!("error: not exported: {}\n  --> {scene}\nhelp: {}", e.what, e.help))
}
