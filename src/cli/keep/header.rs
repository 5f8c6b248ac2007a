//! What the films and rows of a run depend on.

use crate::cli::output::kept_words;
use crate::cli::solve::Request;
use fredholm::engine::by_rays::stream;
use fredholm::engine::rows;
use fredholm::report::state::Header;
use fredholm::scene::Crop;
use fredholm::study::run::Run;
use fredholm::terms::{Part, World};

/// The header of the state of a run: whoever goes on with it, or merges it, must agree in every fact. `roulette` is the schedule
/// of paths where none is asked for.
pub fn header(args: &Request, run: &Run, hash: &str, roulette: &impl ToString, part: Part) -> Header {
    let (settings, [w, h]) = (&run.settings, run.description.camera.size);
    let version = env!("CARGO_PKG_VERSION").into();
    let mut header = Header {
        program: version,
        words: kept_words(),
        spp: settings.spp,
        part: [part.index, part.of],
        ..Header::default()
    };
    header.fact("scene", &run.description.name);
    header.fact("--size", format!("{w}x{h}"));
    if let Some(Crop { from: [x, y], size: [w, h] }) = settings.crop {
        header.fact("--crop", format!("{x},{y},{},{}", x + w, y + h));
    }
    header.fact("--seed", settings.seed);
    header.fact("--max-bounces", settings.max_bounces);
    header.fact("--technique", settings.technique);
    header.fact("--sampling", settings.sampling);
    header.fact("--lights", args.pixels.lights);
    header.fact("--points", settings.points);
    header.fact("most replicates", settings.replicates);
    // an optimal schedule follows from everything else
    let asked = args.light.roulette.as_ref();
    header.fact("--roulette", asked.map_or_else(|| roulette.to_string(), ToString::to_string));
    header.fact("--guide", run.asked.guide.map_or("bsdf".into(), |patches| format!("radiosity, {patches} patches")));
    header.fact("contents of the scene", hash);
    header
}

/// The random streams of the films of a run.
pub fn streams(run: &Run) -> Vec<String> {
    let guided = run.asked.guide.is_some();
    let terms = if run.wants(World::Terms) { run.asked.estimators.as_slice() } else { &[] };
    let path = run.wants(World::Path).then(|| stream(None, guided));
    terms.iter().map(|e| stream(Some(*e), guided)).chain(path).collect()
}

/// The meshes on which a run traces rows of stored rays.
pub fn meshes(run: &Run) -> Vec<String> {
    let wanted = run.wants(World::Radiosity);
    let all = if wanted { rows::meshes(&run.settings) } else { vec![] };
    all.into_iter().map(|patches| rows::mesh(&run.settings, patches)).collect()
}
