//! Exercises: questions with own numbers, answers that are judged and kept, a solution after three tries.

use super::Desk;
use std::fs;

#[test]
fn an_exercise_is_asked_judged_and_solved() {
    let desk = Desk::new();
    let asked = |name: &str| desk.ok(&format!("exercise 10.1 --student {name}")).out;
    assert!(asked("ada").starts_with("Exercise 10.1 for ada: "), "{}", asked("ada"));
    assert_eq!(asked("ada"), asked("Ada"));
    let different = ["ada", "bob", "cleo", "dora", "emil", "finn"].map(|n| asked(n).replace(n, "NAME"));
    assert!(different.iter().any(|q| *q != different[0]), "all students have the same numbers");
    assert!(!desk.path("fredholm-out").exists(), "a question writes nothing");

    let locked = desk.run("exercise 10.1 --student ada --solution");
    assert_eq!(locked.code, 2);
    assert!(locked.err.contains("after a right answer or 3 wrong ones"), "{}", locked.err);
    for n in 1..=3 {
        let said = desk.run("exercise 10.1 --student ada --answer 7");
        assert_eq!(said.code, 1, "{}", said.err);
        assert!(said.out.contains("Not right: 7") && said.out.contains(&format!("{n} wrong answer")), "{}", said.out);
    }
    assert!(!desk.ok("exercise 10.1 --student ada --hint").out.is_empty());
    assert!(!desk.ok("exercise 10.1 --student ada --solution").out.is_empty());

    // the largest q with a finite variance is 1 − ρ²; ρ is one of these
    let tried = |i: u32| {
        let rho = 0.05 * f64::from(i);
        desk.run(&format!("exercise 10.1 --student bob --answer {:.4}", 1.0 - rho * rho)).code
    };
    assert!((1..20).any(|i| tried(i) == 0), "no answer is right");
    assert!(desk.ok("exercise --list --student bob").out.contains("✓ 10.1"));
    assert!(!desk.ok("exercise --list --student ada").out.contains('✓'));
    assert!(!desk.ok("exercise 10.1 --student bob --solution").out.is_empty());
    let kept = fs::read_to_string(desk.path("fredholm-out/exercises/ada.json")).unwrap();
    assert_eq!(kept.matches("\"10.1\"").count(), 3, "{kept}");
}

#[test]
fn a_wrong_number_name_or_answer_says_what_to_type() {
    let desk = Desk::new();
    for (line, what) in [
        ("exercise 10.99 --student ada", "there is no exercise 10.99"),
        ("exercise 99.1 --student ada", "there is no chapter 99"),
        ("exercise ten --student ada", "`ten` is not the number of an exercise"),
        ("exercise 10.1", "--student is missing"),
        ("exercise 10.1 --student ../x", "cannot be the name of a file"),
        ("exercise --answer 3 --student ada", "which exercise?"),
        ("exercise 10.1 --student ada --answer 0,64", "has a comma"),
        ("exercise 10.1 --student ada --answer much", "is not a number"),
        ("exercise 10.1 --student ada --answer 3W", "is not the unit"),
    ] {
        let said = desk.run(line);
        assert_eq!(said.code, 2, "{line}: {}{}", said.out, said.err);
        assert!(said.err.starts_with("error: ") && said.err.contains(what), "{line}: {}", said.err);
        assert!(said.err.contains("\nhelp: "), "{line}: {}", said.err);
    }
    let mut blank = desk.command("exercise 10.1 --student ada --answer");
    let said = blank.arg("").output().unwrap();
    assert_eq!(said.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&said.stderr).contains("the answer is empty"));
    assert!(!desk.path("fredholm-out").exists(), "an answer that cannot be read is no try");

    fs::create_dir_all(desk.path("fredholm-out/exercises")).unwrap();
    fs::write(desk.path("fredholm-out/exercises/ada.json"), "{").unwrap();
    let said = desk.run("exercise 10.1 --student ada --answer 1");
    assert_eq!(said.code, 3);
    assert!(said.err.contains("ada.json") && said.err.contains("move it away"), "{}", said.err);
    assert_eq!(fs::read_to_string(desk.path("fredholm-out/exercises/ada.json")).unwrap(), "{", "nothing is lost");
}

#[test]
fn the_book_is_found_or_the_way_to_build_it_is_told() {
    let desk = Desk::new();
    let said = desk.run("book 99");
    assert_eq!(said.code, 2);
    fs::create_dir_all(desk.path("book/book")).unwrap();
    for page in ["index.html", "10_russian_roulette.html"] {
        fs::write(desk.path("book/book").join(page), "").unwrap();
    }
    assert!(desk.ok("book --no-open").out.trim().ends_with("book/book/index.html"));
    assert!(desk.ok("book 10 --no-open").out.trim().ends_with("10_russian_roulette.html"));
    let said = desk.run("book 9 --no-open");
    assert!(said.code == 2 && said.err.contains("has no page"), "{}", said.err);
}

#[test]
fn the_page_of_commands_has_every_command_and_option() {
    let desk = Desk::new();
    let page = desk.run_wide("man --markdown");
    for what in [
        "## fredholm series",
        "### fredholm check scene",
        "## fredholm exercise",
        "`--max-bounces K`",
        "`-o, --out DIR`",
    ] {
        assert!(page.contains(what), "{what}");
    }
    assert!(!page.contains("<COMMAND>"), "angle brackets are HTML in Markdown");
}
