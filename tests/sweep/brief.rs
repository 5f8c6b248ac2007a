//! By default a command prints the answer in a sentence, small tables, and the place of the files.

use super::*;

/// At most 30 lines, first a sentence, last the files; with --verbose more.
fn assert_brief(line: &str) {
    let desk = TempDir::new().unwrap();
    let said = run(desk.path(), &format!("{line} -q -o out"));
    assert!(said.code <= 1, "{line}: {}{}", said.out, said.err);
    let lines: Vec<&str> = said.out.lines().collect();
    assert!(lines.len() <= 30, "{line} prints {} lines\n{}", lines.len(), said.out);
    assert!(lines.iter().all(|l| l.chars().count() <= 100), "{line}: more than 100 columns\n{}", said.out);
    // the first block is prose: it has a full stop and no rule of a table
    let blocks: Vec<&str> = said.out.split("\n\n").collect();
    let first = blocks[0];
    assert!(first.starts_with(|c: char| c.is_uppercase() || c == '`') && first.ends_with('.'), "{line}: {first}");
    assert!(!first.contains('─') && first.split_whitespace().count() >= 8, "{line}: {first}");
    let last = blocks[blocks.len() - 1];
    assert!(last.starts_with("written to ") && last.contains("summary.json"), "{line}: {last}");
    assert!(last.ends_with("more numbers: --verbose\n"), "{line}: {last}");
    let verbose = run(desk.path(), &format!("{line} -q -o verbose --verbose"));
    assert!(verbose.out.lines().count() > lines.len(), "{line}\n{}", verbose.out);
}

#[test]
fn sweeps_answer_first_and_briefly() {
    for over in ["technique", "sampling", "estimator", "points", "roulette", "branching"] {
        assert_brief(&format!("sweep cornell --over {over} --size 8x8 --spp 32 --max-bounces 3"));
    }
    assert_brief(
        "sweep furnace --over branching --values 1,2,3,4,5,6,7,8,9,10,11,12 --size 4x4 --spp 4 --max-bounces 1",
    );
    assert_brief("sweep cornell --over estimator --size 8x8 --spp 16 --max-bounces 8 --equal-time");
    assert_brief("sweep cornell --over technique --values mis --size 8x8 --spp 1 --max-bounces 2");
    assert_brief("sweep cornell --over spp --estimator single,prefix,path --size 8x8 --max-bounces 3 --spp 64");
    assert_brief("sweep cornell --over spp --reference 64 --size 8x8 --max-bounces 20 --spp 64");
    assert_brief(
        "sweep cornell --over spp --reference 64 --points independent,sobol --size 8x8 --max-bounces 2 --spp 64",
    );
    assert_brief("sweep cornell --over spp --roulette lecture --size 8x8 --max-bounces 2 --spp 16");
    assert_brief("sweep cornell --over split --size 8x8 --max-bounces 12 --spp 32");
}

#[test]
fn roulette_answers_first_and_briefly() {
    let small = "--size 8x8 --spp 32 --max-bounces 6";
    for more in
        ["", "--verify", "--optimise", "--optimise --for whole", "--optimise --for indirect", "--optimise --verify"]
    {
        assert_brief(&format!("roulette cornell {small} {more}"));
    }
    // T0 of the furnace has no noise, and with K = 1 the tail alone is indirect light
    assert_brief("roulette furnace --optimise --size 8x8 --spp 32 --max-bounces 1");
}

/// The sentence names the value with the least variance times rays of the CSV file.
#[test]
fn the_sentence_is_that_of_the_file() {
    let s = swept("cornell --over technique --size 64x64 --spp 64 --max-bounces 3 -q");
    let work = |v: &str| s.number(v, "all", "variance") * s.number(v, "all", "rays_per_path");
    let best = s.values().into_iter().min_by(|a, b| work(a).total_cmp(&work(b))).unwrap();
    let answer = s.said.out.split("\n\n").next().unwrap().replace('\n', " ");
    // where the noise does not tell the techniques apart, the sentence says so, and names them all
    let told = answer.starts_with(&format!("Among the techniques, `{best}`"));
    let untold = answer.starts_with("The noise of 64 samples per pixel does not tell the techniques");
    assert!(told || untold, "{best}: {answer}");
    for technique in s.values() {
        assert!(answer.contains(&format!("`{technique}`")), "{technique}: {answer}");
    }
}
