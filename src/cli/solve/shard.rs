//! `--shard I/N`: renders one part of a run, or traces its rows of stored rays, into a file.

use super::{Default, Request, opened};
use crate::cli::base::{Ending, Failure, note, usage};
use crate::cli::claim::{Claim, Denied};
use crate::cli::keep::{self, Interval, Keeper, Shard};
use crate::cli::output::{command_of, kept_words};
use crate::cli::session::Session;
use fredholm::engine::by_rays::{Begins, Estimator};
use fredholm::engine::discretisation::Factors;
use fredholm::report::state::State;
use fredholm::study::run::Run;
use fredholm::terms::{Shape, World};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What is printed with `--json`.
#[derive(Serialize)]
struct Record<'a> {
    file: &'a Path,
    shard: String,
    spp: u32,
    finished: bool,
}

/// Renders a part, goes on with one that was stopped, or finds it finished.
pub fn render(args: &Request, default: &Default, shard: Shard) -> Result<Ending, Failure> {
    if args.keeping.resume {
        return Err(usage("a part goes on by itself where it was stopped", "leave --resume out"));
    }
    let mut session = Session::new(&args.shared, args.frame.seed)?;
    let (mut run, hash) = opened(args, default, &mut session)?;
    can_be_divided(&run, shard)?;
    let path =
        args.shared.out.clone().unwrap_or_else(|| file(&format!("{}{}", run.description.name, default.name), shard));
    if path.is_dir() {
        return Err(usage(
            &format!("{} is a folder, and a part is one file", path.display()),
            "name a file, such as 3.fsh, with -o",
        ));
    }
    if let Some(folder) = path.parent().filter(|p| !p.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder)?;
    }
    let _claim = Claim::file(&path, session.command()).map_err(|denied| match denied {
        Denied::Taken => {
            Failure::at(&path, "another run is writing this part", "wait until it ends, or choose another file with -o")
        }
        Denied::Failed(e) => {
            Failure::at(&path, &format!("the part cannot be written: {e}"), "choose another file with -o")
        }
    })?;
    let header = keep::header(args, &run, &hash, &default.roulette, shard.0);
    let spp = header.spp;
    let mut keeper = Keeper::of_part(path.clone(), header, args.keeping.checkpoint.unwrap_or(Interval::USUAL));
    if path.exists() && !args.shared.force {
        const OTHER: &str = "choose another file with -o, or replace it with --force";
        let state = State::open(&path).map_err(|e| Failure::at(&path, &e.cause, OTHER))?;
        if state.header.part() != shard.0 {
            let what = format!("this is part {}, not {shard}", Shard(state.header.part()));
            return Err(Failure::at(&path, &what, OTHER));
        }
        let (words, before) = (state.header.words.clone(), state.header.spp);
        keeper.go_on(state, &run)?;
        if !keep::same_command(&words, &kept_words()) {
            let what = format!("this is a part of another command: {}", command_of(&words));
            return Err(Failure::at(&path, &what, OTHER));
        }
        // rows do not depend on the samples, but `merge` looks for their number
        if before != spp && keep::streams(&run).is_empty() {
            keeper.renew()?;
        }
        if !session.quiet() {
            note(&keeper.stand(&run));
        }
    }
    if !keeper.finished(&run) {
        run.part(session.progress(), &keeper)?;
    }
    session.clear();
    let finished = keeper.finished(&run);
    if !finished && !session.stopped() {
        return Err(Failure::input(&format!(
            "error: part {shard} is not written\nhelp: check the disk of {}",
            path.display()
        )));
    }
    let record = Record { file: &path, shard: shard.to_string(), spp, finished };
    session.show(&record, || match finished {
        true => {
            format!("part {shard} is finished: {}\nwhen all parts are: fredholm merge FILES -o FOLDER", path.display())
        }
        false if !keeper.kept() => {
            format!("part {shard} was stopped, and nothing is kept\nrepeat the command to begin again")
        }
        false => {
            format!("part {shard} was stopped, and its state is kept: {}\nrepeat the command to go on", path.display())
        }
    })?;
    Ok(session.ending(false))
}

/// The usual name of the file of a part.
fn file(name: &str, shard: Shard) -> PathBuf {
    PathBuf::from("fredholm-out").join(format!("{name}-{}.fsh", shard.to_string().replace('/', "-of-")))
}

/// Refuses more parts than there is work for, and a run with neither films nor stored rays.
fn can_be_divided(run: &Run, shard: Shard) -> Result<(), Failure> {
    let of = shard.0.of;
    let traces = run.wants(World::Terms) || run.wants(World::Path);
    if !traces && run.settings.factors == Factors::Dense {
        let help = "use --factors rays, whose rows can be divided, or leave --shard out";
        let both = if run.asked.against_rays.is_some() { ", and --factors both needs one" } else { "" };
        return Err(usage(&format!("a dense matrix is not made in parts{both}"), help));
    }
    if !traces && of as usize > run.settings.patches {
        let what = format!("{of} parts are too many: the mesh has about {} patches", run.settings.patches);
        return Err(usage(&what, "choose fewer parts"));
    }
    let shape = Shape { size: run.size(), slots: 1, replicates: 1 };
    let blocks = shape.blocks();
    let gathers = run.wants(World::Path) || run.asked.estimators.iter().any(|e| e.begins() == Begins::AtEye);
    if gathers && of as usize > blocks {
        return Err(usage(
            &format!(
                "{of} parts are too many: the {} has {blocks} block{} of 64 pixels",
                if run.settings.crop.is_some() { "crop" } else { "picture" },
                if blocks == 1 { "" } else { "s" }
            ),
            "choose fewer parts",
        ));
    }
    let replicates = run.settings.replicates_of(run.settings.spp);
    let splats = |e: &&Estimator| e.begins() != Begins::AtEye;
    if let Some(e) = run.asked.estimators.iter().find(splats).filter(|_| of > replicates) {
        let what = format!("{e} is divided by replicates, and there are {replicates}: too few for {of} parts");
        return Err(usage(&what, "choose fewer parts"));
    }
    Ok(())
}
