//! `fredholm zoo --quiz`: a table of r_k without a name; predict, then reveal.

use super::args::Zoo;
use super::words::{brief, introduction, whole};
use crate::cli::base::{Ending, Failure, note, paragraphs, print};
use crate::cli::session::Session;
use fredholm::engine::by_rays;
use fredholm::math::{Key, Purpose, Rng};
use fredholm::scene::Scene;
use fredholm::zoo::signature::measured;
use fredholm::zoo::{self, Bug};
use std::io::BufRead;

/// Names to choose from.
const CHOICES: usize = 4;

/// Asks as many rounds as were wanted; answers are lines of stdin, and where it ends the rest is revealed.
pub fn run(args: &Zoo) -> Result<Ending, Failure> {
    let mut lines = std::io::stdin().lock().lines();
    let (settings, session) = (args.settings(64), Session::new(args, args.seed)?);
    let progress = session.progress();
    let order = shuffled(args.seed, 0, zoo::all());
    let (mut right, mut answered, mut asked) = (0, 0, 0);
    print("Which mistake was made? rₖ = Tₖ of the suspect / Tₖ of the right renderer. Answer with a number.")?;
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
            table.push(format!("  {bad} samples are no number"));
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
        print(&format!("\n{verdict}: it is\n{}", introduction(bug)))?;
    }
    print(&format!("\n{right} of {answered} right, {asked} asked"))?;
    Ok(Ending::Ok)
}

/// The next line that is a number; other lines are asked for again, and the end of the input is no answer.
fn answer(lines: &mut impl Iterator<Item = std::io::Result<String>>) -> Result<Option<usize>, Failure> {
    for line in lines.by_ref() {
        match line?.trim().parse() {
            Ok(n) if (1..=CHOICES).contains(&n) => return Ok(Some(n)),
            _ => note(&format!("a number from 1 to {CHOICES}, please")),
        }
    }
    Ok(None)
}

/// The member and three others, in an order of the seed's.
fn choices(seed: u64, round: u32, bug: &'static Bug) -> Vec<&'static Bug> {
    let others = zoo::all().into_iter().filter(|b| !std::ptr::eq(*b, bug)).collect();
    let mut all: Vec<_> = shuffled(seed, 2 * round, others).into_iter().take(CHOICES - 1).collect();
    all.push(bug);
    shuffled(seed, 2 * round + 1, all)
}

/// Fisher and Yates (1938), by addressed numbers.
fn shuffled<T>(seed: u64, round: u32, mut items: Vec<T>) -> Vec<T> {
    for i in (1..items.len()).rev() {
        let u = Rng::at(Key::new(seed, "quiz"), round, i as u32, 0, Purpose::Start).one();
        items.swap(i, ((u * (i + 1) as f32) as usize).min(i));
    }
    items
}
