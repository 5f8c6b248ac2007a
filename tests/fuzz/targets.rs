//! The readers that are fuzzed. Each takes the bytes of one file, writes them to a folder, and reads that file as the program does. What is
//! read must be sound, and what is refused must be refused in words.
//!
//! ```text
//! memory of one case ≤ 64 MiB + m × bytes of the file
//! ```
//!
//! m is a constant of each reader ([`Target::per_byte`]). For images it is the memory of a pixel times the pixels that a byte can hold
//! (`scene/image_header.rs`).
//!
//! A new reader is a function here, a line in [`TARGETS`], a folder `corpus/NAME` with examples, and a program of libFuzzer
//! (`fuzz/README.md`).

use fredholm::report::image::foreign;
use fredholm::report::state;
use fredholm::report::text::{summary, table};
use fredholm::scene::{
    Scene, SceneError,
    load::{Loaded, Options, scene, toml},
};
use fredholm::stats::{Criterion, compare, discretisation};
use fredholm::terms::Shape;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Memory is counted, and an allocation beyond the limit fails, which ends the process.
#[global_allocator]
static MEMORY: cap::Cap<std::alloc::System> = cap::Cap::new(std::alloc::System, usize::MAX);

/// Seconds that a case may take.
const SLOWEST: Duration = Duration::from_secs(10);
/// Bytes that every case may use.
const BASE: usize = 64 << 20;

/// A reader.
pub struct Target {
    /// Its name, and that of its corpus.
    pub name: &'static str,
    /// Bytes of memory per byte of the file, beyond [`BASE`].
    pub per_byte: usize,
    /// Reads a file; true if it was accepted.
    pub read: fn(&Desk, &[u8]) -> bool,
}

/// All readers.
pub const TARGETS: &[Target] = &[
    Target {
        name: "toml",
        per_byte: 1 << 13,
        read: |desk, bytes| loaded(&scene(&desk.put("scene.toml", bytes), &plain())),
    },
    Target { name: "set", per_byte: 1 << 13, read: set },
    Target {
        name: "obj",
        per_byte: 1 << 13,
        read: |desk, bytes| loaded(&scene(&desk.put("mesh.obj", bytes), &plain())),
    },
    Target { name: "mtl", per_byte: 1 << 13, read: mtl },
    Target { name: "exr", per_byte: 1 << 16, read: |desk, bytes| image(desk, "exr", bytes) },
    Target { name: "hdr", per_byte: 1 << 16, read: |desk, bytes| image(desk, "hdr", bytes) },
    Target { name: "jpeg", per_byte: 1 << 15, read: |desk, bytes| image(desk, "jpg", bytes) },
    Target { name: "png", per_byte: 1 << 18, read: |desk, bytes| image(desk, "png", bytes) },
    Target { name: "summary", per_byte: 1 << 10, read: finished },
    Target { name: "state", per_byte: 1 << 6, read: state },
];

impl Target {
    /// The reader of that name.
    ///
    /// # Panics
    /// If there is none.
    #[allow(dead_code, reason = "the test takes them all")]
    pub fn named(name: &str) -> &'static Self {
        TARGETS.iter().find(|t| t.name == name).unwrap_or_else(|| panic!("no target {name}"))
    }

    /// Reads one file within the limits; true if it was accepted.
    ///
    /// # Panics
    /// If what was read is not sound, if it was refused without words, or if it took too long. Too much memory aborts.
    pub fn check(&self, desk: &Desk, bytes: &[u8]) -> bool {
        let begin = Instant::now();
        MEMORY.set_limit(MEMORY.allocated() + BASE + self.per_byte * bytes.len()).unwrap();
        let read = (self.read)(desk, bytes);
        MEMORY.set_limit(usize::MAX).unwrap();
        assert!(begin.elapsed() < SLOWEST, "{}: {:?} for {} bytes", self.name, begin.elapsed(), bytes.len());
        read
    }
}

/// A folder with the files that the cases name. It keeps the last case.
pub struct Desk {
    folder: PathBuf,
}

impl Desk {
    /// Fills a folder.
    pub fn new(folder: &Path) -> Self {
        let desk = Self { folder: folder.to_owned() };
        std::fs::create_dir_all(folder).unwrap();
        let texels = image::RgbImage::from_fn(2, 1, |x, _| image::Rgb([[0, 10, 11], [128, 188, 255]][x as usize]));
        texels.save(folder.join("wall.png")).unwrap();
        image::Rgb32FImage::from_pixel(2, 1, image::Rgb([0.5, 1.0, 2.0])).save(folder.join("sky.hdr")).unwrap();
        desk.put("mesh.obj", MESH.as_bytes());
        desk.put(
            "mesh.mtl",
            b"newmtl a\nKd 0.5 0.5 0.5\nnewmtl b\nKe 1 1 1\nKs 0.2 0.2 0.2\nNs 10\nnewmtl c\nmap_Kd wall.png\n",
        );
        desk
    }

    /// Writes a file and returns its path.
    fn put(&self, name: &str, bytes: &[u8]) -> String {
        let path = self.folder.join(name);
        // a new file: some file systems wait for the disk where a file is emptied and written again
        let _ = std::fs::remove_file(&path);
        std::fs::write(&path, bytes).unwrap();
        path.to_str().unwrap().to_owned()
    }
}

/// A mesh with three materials, on a square and a triangle with texture coordinates.
const MESH: &str = "mtllib mesh.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n\
                    usemtl a\nf 1 2 3 4\nusemtl b\nf 1 3 4\nusemtl c\nf 1/1 2/2 3/3\n";

fn plain() -> Options {
    Options::default()
}

/// What was loaded is sound: finite, with area, lit, every index in range, and the scene that is built from it renders.
fn loaded(read: &Result<Loaded, SceneError>) -> bool {
    match read {
        Ok(l) => {
            let d = &l.description;
            assert!(d.primitives().iter().all(|(_, p)| p.area() > 0.0 && p.area().is_finite()));
            assert!(d.shapes.iter().all(|s| s.material < d.materials.len() && s.emission.is_finite()));
            assert!(d.shapes.iter().any(|s| s.emission.max_element() > 0.0) || !d.lights.is_empty());
            assert!(d.camera.origin.is_finite() && d.camera.size.iter().all(|&n| n > 0));
            drop(Scene::new(d));
            true
        }
        Err(e) => {
            assert!(!e.what.is_empty() && e.help.is_some(), "{e}");
            false
        }
    }
}

/// `--set` with the first half of the lines, `--emit` with the others.
fn set(_: &Desk, bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let mut set: Vec<String> = text.lines().map(str::to_owned).collect();
    let emit = set.split_off(set.len().div_ceil(2));
    let source = fredholm::scene::builtin::find("cornell").unwrap().source;
    loaded(&toml(source, Path::new("cornell.toml"), &Options { set, emit, lambertian: false }))
}

fn mtl(desk: &Desk, bytes: &[u8]) -> bool {
    desk.put("mesh.mtl", bytes);
    let options = Options { emit: vec!["a=1,1,1".into()], ..plain() };
    loaded(&scene(&desk.put("mesh.obj", MESH.as_bytes()), &options))
}

/// A texture, a sky, and a picture of another renderer.
fn image(desk: &Desk, ending: &str, bytes: &[u8]) -> bool {
    let name = format!("image.{ending}");
    let path = desk.put(&name, bytes);
    let wall = format!("[materials.m]\ntype = \"diffuse\"\ntexture = \"{name}\"\n");
    let grey = "[materials.m]\ntype = \"diffuse\"\nreflectance = [0.5, 0.5, 0.5]\n".to_owned();
    let sky = |file: &str| format!("[[lights]]\ntype = \"environment\"\nfile = \"{file}\"\nmapping = \"latlong\"\n");
    let quad =
        "[[shapes]]\ntype = \"quad\"\norigin = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\nmaterial = \"m\"\n";
    let camera = "[camera]\norigin = [0, 0, 4]\ntarget = [0, 0, 0]\nup = [0, 1, 0]\nfov = 40\nsize = [8, 6]\n";
    let file = desk.folder.join("scene.toml");
    let mut read = 0;
    for text in [wall + quad + &sky("sky.hdr"), grey + quad + &sky(&name)] {
        match toml(&format!("{camera}{text}"), &file, &plain()) {
            Ok(_) => read += 1,
            Err(e) => assert!(!e.what.is_empty() && e.help.is_some(), "{e}"),
        }
    }
    match foreign::read(Path::new(&path)) {
        Ok(f) => {
            let pixels = f.pictures.size[0] * f.pictures.size[1];
            assert!(pixels > 0 && f.pictures.layers.iter().all(|l| l.mean.len() == pixels));
            read += 1;
        }
        Err(e) => assert!(!e.cause.is_empty() && !e.help.is_empty(), "{e}"),
    }
    read > 0
}

/// A state, or a part of a run: its header, and its films and rows if they have the shape of the corpus.
fn state(_: &Desk, bytes: &[u8]) -> bool {
    let mut file = std::io::Cursor::new(bytes);
    let header = match state::header(&mut file) {
        Ok(header) => header,
        Err(e) => {
            assert!(!e.to_string().is_empty());
            return false;
        }
    };
    let shape = Shape { size: [16, 9], slots: 4, replicates: 4 };
    let read = |entry: &state::Entry| match state::film_of(&mut file.clone(), entry, header.part(), shape) {
        Ok((film, _)) => film.shape == shape,
        Err(e) => {
            assert!(!e.to_string().is_empty());
            false
        }
    };
    let rows = |entry: &state::RowsEntry| match state::rows_of(&mut file.clone(), entry, header.part(), [12, 16]) {
        Ok(rows) => rows.n == 12,
        Err(e) => {
            assert!(!e.to_string().is_empty());
            false
        }
    };
    header.films.iter().any(read) | header.rows.iter().any(rows)
}

/// A result, compared with itself as `fredholm compare` does.
fn finished(desk: &Desk, bytes: &[u8]) -> bool {
    let path = desk.put("summary.json", bytes);
    match summary::read(Path::new(&path)) {
        Ok(s) => {
            for (a, b) in s.series.iter().zip(s.series.iter().rev()) {
                let whole = a.gap(b).map_or_else(|| a.clone(), |(from, _)| a.before(from));
                let found = compare(&whole, b, &Criterion::default(), &discretisation(a, b));
                let _ = table::verdicts(&summary::verdicts("", &found));
            }
            true
        }
        Err(e) => {
            assert!(!e.cause.is_empty() && !e.help.is_empty(), "{e}");
            false
        }
    }
}
