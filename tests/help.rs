//! Help, suggestions for what is mistyped, completions and man pages: of every command that clap knows, so that new ones are
//! covered.
#![allow(clippy::unwrap_used)]

#[path = "common/program.rs"]
#[allow(dead_code, unreachable_pub)]
mod program;

use program::{Said, command, run};
use std::path::Path;
use tempfile::TempDir;

/// Help as a terminal of that width shows it.
fn help(words: &str, columns: u32) -> String {
    let output = command(Path::new("."), words).env("COLUMNS", columns.to_string()).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The commands that a help lists.
fn listed(help: &str) -> Vec<String> {
    let list = help.lines().skip_while(|l| *l != "Commands:").skip(1).take_while(|l| !l.is_empty());
    let names = list.filter(|l| l.starts_with("  ") && !l.starts_with("   "));
    names.map(|l| l.split_whitespace().next().unwrap().to_owned()).filter(|n| n != "help").collect()
}

/// Every command with the words that call it; the program itself is the empty one.
fn commands() -> Vec<String> {
    let mut all = vec![String::new()];
    let mut next = 0;
    while next < all.len() {
        let words = all[next].clone();
        all.extend(listed(&help(&format!("{words} -h"), 100)).iter().map(|name| format!("{words} {name}")));
        next += 1;
    }
    assert!(all.len() > 18, "{all:?}");
    all.into_iter().map(|words| words.trim().to_owned()).collect()
}

fn refused(line: &str) -> Said {
    let desk = TempDir::new().unwrap();
    let said = run(desk.path(), line);
    assert!(said.err.starts_with("error: ") && said.err.contains("\nhelp: "), "{line}: {}", said.err);
    assert!(said.out.is_empty(), "{line}: {}", said.out);
    assert!(!desk.path().join("fredholm-out").exists(), "{line}: nothing is written");
    said
}

#[test]
fn short_help_fits_a_screen_and_every_line_fits_the_terminal() {
    for words in commands() {
        let short = help(&format!("{words} -h"), 80);
        assert!(short.lines().count() <= 40, "{words}: {} lines\n{short}", short.lines().count());
        assert!(short.contains("--help"), "{words}: says where all options are");
        for columns in [80, 100] {
            for flag in ["-h", "--help"] {
                let text = help(&format!("{words} {flag}"), columns);
                for line in text.lines() {
                    assert!(line.chars().count() <= columns as usize, "{words} {flag} at {columns}: {line}");
                }
                assert!(!text.contains("\n\n\n"), "{words} {flag}: two blank lines in a row");
            }
        }
        let long = help(&format!("{words} --help"), 80);
        assert!(long.contains("Examples:\n  fredholm"), "{words}: has examples\n{long}");
    }
}

/// An orphan is a line of one or two words in the middle of a paragraph, where the text was broken by hand.
#[test]
fn paragraphs_have_no_orphans() {
    for words in commands() {
        for columns in [80, 100] {
            let text = help(&format!("{words} --help"), columns);
            let lines: Vec<&str> = text.lines().collect();
            for three in lines.windows(3) {
                let indent = |l: &str| l.len() - l.trim_start().len();
                let [before, line, after] = [three[0], three[1], three[2]];
                let within = three.iter().all(|l| !l.trim().is_empty() && indent(l) == indent(line));
                let prose = |l: &str| l.split_whitespace().count() > 6 && !l.contains("  fredholm ");
                if within && prose(before) && prose(after) {
                    assert!(line.split_whitespace().count() > 2, "{words} at {columns}: {line}");
                }
            }
        }
    }
}

#[test]
fn options_are_grouped_and_only_those_that_act_are_listed() {
    for words in ["tour", "series", "render", "radiosity", "sweep", "walk", "roulette", "check bias", "diagnose"] {
        let text = help(&format!("{words} --help"), 80);
        let at = |heading| text.find(heading).unwrap_or_else(|| panic!("{words} has no {heading}"));
        assert!(at("\nWhat:\n") < at("\nHow:\n") && at("\nHow:\n") < text.len(), "{words}");
        assert!(text.contains("\nOutput:\n") && !text.contains("\nOptions:\n"), "{words}");
    }
    let lists = |words, option| help(&format!("{words} --help"), 80).contains(&format!("--{option}"));
    for (command, option, expected) in [
        ("series", "patches", true),
        ("series", "technique", true),
        ("series", "estimator", true),
        ("tour", "estimator", false),
        ("render", "technique", true),
        ("render", "patches", false),
        ("render", "worlds", false),
        ("render", "estimator", false),
        ("radiosity", "patches", true),
        ("radiosity", "technique", false),
        ("radiosity", "worlds", false),
        ("radiosity", "roulette", false),
        ("sweep", "worlds", false),
    ] {
        assert_eq!(lists(command, option), expected, "{command} --{option}");
        if !expected {
            let said = refused(&format!(
                "{command} cornell --{option} 1{}",
                if command == "sweep" { " --over spp" } else { "" }
            ));
            assert_eq!(said.code, 2);
            assert!(said.err.contains(&format!("--{option} is an option of")), "{}", said.err);
        }
    }
}

#[test]
fn a_mistyped_word_gets_a_suggestion() {
    for (line, code, says) in [
        ("seris cornell", 2, "did you mean `fredholm series cornell`?"),
        ("rendr --spp 4", 2, "did you mean `fredholm render --spp 4`?"),
        ("cornel", 2, "did you mean `fredholm cornell`?"),
        ("nothing-like-it", 2, "commands: tour, series"),
        ("nothing-like-it", 2, "scenes: cornell, furnace"),
        ("check bia", 2, "did you mean `fredholm check bias`?"),
        ("zoo double", 2, "did you mean `double-emission`"),
        ("zoo double-emision", 2, "did you mean `double-emission`"),
        ("series cornell --technique nee", 2, "did you mean `connect`? next-event estimation is called `connect` here"),
        ("series cornell --technique NEE", 2, "did you mean `connect`?"),
        ("series cornell --technique conect", 2, "did you mean `connect`?"),
        ("series cornell --technique bsdf", 2, "did you mean `scatter`?"),
        ("series cornell --estimator bdpt", 2, "did you mean `bidirectional`?"),
        ("series cornell --estimator pt", 2, "`fredholm render`"),
        ("series cornell --estimator prefx", 2, "did you mean `prefix`?"),
        ("series cornell --sampling brdf", 2, "did you mean `bsdf`?"),
        ("series cornell --points halton", 2, "did you mean `sobol`?"),
        ("series cornell --lights bvh", 2, "did you mean `power`?"),
        ("series cornell --roulette rr", 2, "did you mean `lecture`?"),
        ("series cornell --roulette 0.3", 2, "did you mean `constant:0.3`?"),
        ("series cornell --worlds matrix", 2, "did you mean `radiosity`?"),
        ("series cornell --techniqe mis", 2, "did you mean `--technique`?"),
        ("series cornell --spp many", 2, "--spp: `many` is not a whole number"),
        ("series cornell --spp 0", 2, "--spp: 0 is not between 1 and 16777216"),
        ("radiosity cornell --solver shooting", 2, "did you mean `southwell`?"),
        ("walk cornell --technique nee", 2, "did you mean `connect`?"),
        ("check bias --technique nee", 2, "did you mean `connect`?"),
        ("sweep cornell --over techniqe", 2, "did you mean `technique`?"),
        ("sweep cornell --over spp --technique nee,mis", 2, "did you mean `connect`?"),
        ("sweep cornell --over sampling --technique nee", 2, "did you mean `connect`?"),
        ("sweep cornell --over technique --values nee", 2, "did you mean `connect`?"),
        ("roulette cornell --schedules rr", 2, "did you mean `lecture`?"),
        ("figure kajiya", 2, "did you mean `kajiya-series`?"),
        ("chapter one", 2, "did you mean `fredholm chapter 1`?"),
        ("chapter box", 2, "did you mean `fredholm chapter 1`?"),
        ("chapter 99", 2, "`fredholm chapter` lists the chapters"),
        ("completions bsh", 2, "did you mean `bash`?"),
        ("check", 2, "`fredholm check COMMAND`, where COMMAND is `bias`, `equilibrium` or `scene`"),
        ("compare a", 2, "required arguments were not provided: <B>"),
        ("series cornel", 3, "did you mean `cornell`? built-in scenes: cornell, furnace, sphere"),
        ("zoo double-emission --scene cornel", 2, "did you mean `cornell`?"),
    ] {
        let said = refused(line);
        assert_eq!(said.code, code, "{line}: {}", said.err);
        assert!(said.err.contains(says), "{line}: {}", said.err);
    }
}

#[test]
fn a_missing_scene_lists_those_that_exist() {
    let every: Vec<&str> = fredholm::scene::builtin::names().to_vec();
    for line in
        ["series nowhere", "info nowhere", "render nowhere.toml", "walk none/nowhere.obj", "sweep nowhere --over spp"]
    {
        let said = refused(line);
        assert_eq!(said.code, 3, "{line}: {}", said.err);
        let list = said.err.lines().find(|l| l.contains("built-in scenes: ")).unwrap();
        assert!(every.iter().all(|name| list.contains(name)), "{line}: {list}");
    }
    let desk = TempDir::new().unwrap();
    std::fs::write(desk.path().join("kitchen.toml"), "").unwrap();
    let said = run(desk.path(), "info kitchn.toml");
    assert!(said.err.contains("the file `kitchn.toml` does not exist"), "{}", said.err);
    assert!(said.err.contains("did you mean `kitchen.toml`? the folder searched is /"), "{}", said.err);
    assert!(run(desk.path(), "info kitchen").err.contains("did you mean `kitchen.toml`?"));
    assert!(run(desk.path(), "info none/a.toml").err.contains("there is no folder `none`"));
}

#[test]
fn a_first_word_that_is_a_scene_or_an_option_is_the_tour() {
    let desk = TempDir::new().unwrap();
    let small = "--size 8x8 --spp 16 --patches 20 --max-bounces 1 -q";
    for line in [format!("tour furnace {small} -o a"), format!("furnace {small} -o b"), format!("{small} -o c")] {
        let said = run(desk.path(), &line);
        assert!(said.code <= 1, "{line}: {}", said.err);
    }
    assert!(["a", "b", "c"].iter().all(|dir| desk.path().join(dir).join("index.html").is_file()));
    assert_eq!(run(desk.path(), "none.toml").code, 3);
}

#[test]
fn default_folders_say_what_they_hold() {
    let desk = TempDir::new().unwrap();
    let small = "--size 8x8 --spp 16 --max-bounces 1 -q";
    for (line, folder) in [
        ("furnace --patches 20", "furnace"),
        ("series furnace --worlds terms", "furnace-series"),
        ("render furnace", "furnace-render"),
        ("radiosity furnace --patches 20", "furnace-radiosity"),
        ("sweep furnace --over sampling", "furnace-sweep-sampling"),
        ("roulette furnace", "furnace-roulette"),
    ] {
        let said = run(desk.path(), &format!("{line} {small}"));
        assert!(said.code <= 1, "{line}: {}", said.err);
        assert!(desk.path().join("fredholm-out").join(folder).join("summary.json").is_file(), "{line}: {folder}");
    }
}

#[test]
fn chapters_print_readable_mathematics() {
    let desk = TempDir::new().unwrap();
    for line in ["chapter", "chapter -h", "chapter --help", "chapter 1"] {
        let said = run(desk.path(), line);
        assert_eq!(said.code, 0, "{line}: {}", said.err);
        for mark in ["$", "\\T", "\\norm", "_{", "^{"] {
            assert!(!said.out.contains(mark), "{line}: {mark} in\n{}", said.out);
        }
    }
    assert!(run(desk.path(), "chapter").out.contains("‖TᵏE‖₁"));
}

#[test]
fn completions_know_every_command() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = help(&format!("completions {shell}"), 80);
        for words in commands() {
            assert!(words.split(' ').all(|word| script.contains(word)), "{shell}: {words}");
        }
        assert!(script.contains("--max-bounces") || script.contains("max-bounces"), "{shell}");
    }
    assert!(help("completions zsh", 80).contains("next-event estimation"), "values have descriptions");
}

#[test]
fn every_command_has_a_man_page() {
    let desk = TempDir::new().unwrap();
    let said = run(desk.path(), "man pages");
    assert_eq!(said.code, 0, "{}", said.err);
    for words in commands() {
        let name = format!("fredholm {words}").trim().replace(' ', "-");
        let page = std::fs::read_to_string(desk.path().join(format!("pages/{name}.1"))).unwrap();
        assert!(page.contains(".SH NAME") && page.contains(".SH SYNOPSIS"), "{name}");
    }
    let printed = run(desk.path(), "man").out;
    assert!(printed.contains(".SH NAME") && printed.contains("fredholm\\-series"), "{printed}");
}

/// `fredholm series --help | head`: a reader that has seen enough is no error.
#[test]
fn a_closed_pipe_is_no_error() {
    let desk = tempfile::tempdir().unwrap();
    let mut child = command(desk.path(), "series --help")
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), String::from_utf8_lossy(&output.stderr).as_ref()), (Some(0), ""));
}
