//! `fredholm zoo --quiz`: shows a table of ratios r_k without the name of the mistake, asks for it, and reveals it.

use super::args::Zoo;
use super::words::{brief, facts, mistake, whole};
use crate::cli::base::{Ending, Failure, note, paragraphs, print};
use crate::cli::session::Session;
use fredholm::engine::by_rays;
use fredholm::math::{Key, Purpose, Rng};
use fredholm::report::text::prose::wrapped;
use fredholm::scene::Scene;
use fredholm::zoo::signature::measured;
use fredholm::zoo::{self, Bug};
use std::io::BufRead;

/// Number of names to choose from.
const CHOICES: usize = 4;

/// Plays the rounds. Answers are lines of stdin; where it ends, the remaining rounds are revealed.
pub fn run(args: &Zoo) -> Result<Ending, Failure> {
    let mut lines = std::io::stdin().lock().lines();
    let (settings, session) = (args.settings(64), Session::new(args, args.seed)?);
    let progress = session.progress();
    let order = shuffled(args.seed, 0, zoo::all());
    let (mut right, mut answered, mut asked) = (0, 0, 0);
    print(&wrapped(
        "Which mistake was made? Answer with a number.\n\
         A table shows rₖ = mean of the wrong term Tₖ/mean of the right one; in brackets the 95 % interval of the last digits.",
    ))?;
    for (round, &bug) in order.iter().cycle().take(args.rounds as usize).enumerate() {
        let scene = Scene::new(&bug.exposed_by.load(args.size)?);
        let truth = by_rays::terms(&scene, by_rays::Estimator::Prefix, &settings, progress);
        let suspect = zoo::render(bug, &scene, &settings, progress);
        session.clear();
        if session.stopped() {
            return Ok(Ending::Interrupted);
        }
        let (a, b) = (suspect.series.image(), truth.series.image());
        let mut table: Vec<String> =
            measured(a, b).iter().enumerate().map(|(k, r)| format!("  r{k}     {}", brief(r))).collect();
        table.push(format!("  whole  {}", brief(&whole(a, b))));
        let bad = suspect.series.cost.non_finite;
        if bad > 0 {
            table.push(format!("  {bad} samples of the wrong estimator are no number"));
        }
        let choices = choices(args.seed, round as u32 + 1, bug);
        let named: Vec<String> =
            choices.iter().enumerate().map(|(i, b)| format!("  {}  {}: {}", i + 1, b.name, b.what)).collect();
        let head = format!("{} of {}, scene {}", round + 1, args.rounds, bug.exposed_by.label);
        print(&format!("\n{}", paragraphs(&[format!("{head}\n{}", table.join("\n")), named.join("\n")])))?;
        asked += 1;

        let verdict = match answer(&mut lines)? {
            None => "not answered".to_string(),
            Some(n) => {
                answered += 1;
                let hit = choices.get(n.wrapping_sub(1)).is_some_and(|b| std::ptr::eq(*b, bug));
                right += u32::from(hit);
                if hit { "right".into() } else { "no".to_string() }
            }
        };
        print(&format!("\n{verdict}: it is\n{}\n{}", mistake(bug), facts(bug)))?;
    }
    print(&format!("\nScore: {right} of {answered} right, {asked} asked."))?;
    Ok(Ending::Ok)
}

/// The answer on the next line that is a valid number; asks again after other lines. `None` at the end of the input.
fn answer(lines: &mut impl Iterator<Item = std::io::Result<String>>) -> Result<Option<usize>, Failure> {
    for line in lines.by_ref() {
        match line?.trim().parse() {
            Ok(n) if (1..=CHOICES).contains(&n) => return Ok(Some(n)),
            _ => note(&format!("please answer with a number from 1 to {CHOICES}")),
        }
    }
    Ok(None)
}

/// The member and three others, in a random order that depends on the seed.
fn choices(seed: u64, round: u32, bug: &'static Bug) -> Vec<&'static Bug> {
    let others = zoo::all().into_iter().filter(|b| !std::ptr::eq(*b, bug)).collect();
    let mut all: Vec<_> = shuffled(seed, 2 * round, others).into_iter().take(CHOICES - 1).collect();
    all.push(bug);
    shuffled(seed, 2 * round + 1, all)
}

/// A random permutation (Fisher and Yates 1938) that depends only on the seed and the round.
fn shuffled<T>(seed: u64, round: u32, mut items: Vec<T>) -> Vec<T> {
    for i in (1..items.len()).rev() {
        let u = Rng::at(Key::new(seed, "quiz"), round, i as u32, 0, Purpose::Start).one();
        items.swap(i, ((u * (i + 1) as f32) as usize).min(i));
    }
    items
}
