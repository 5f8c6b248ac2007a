//! `fredholm exercise [N.M]`: asks a question with the student's own numbers, and judges the answer.

mod tries;

use super::base::{Ending, Failure, print, usage};
use super::options::{OUTPUT, WHAT};
use super::programs::CHAPTERS;
use clap::Args;
use fredholm::report::book::Chapter;
use fredholm::report::exercise::{Exercise, Student, Unreadable};
use fredholm::report::text::prose::{counted, wrapped, wrapped_after};
use std::path::PathBuf;
use tries::{Tries, Try};

/// Below `exercise --help`.
pub const HELP: &str = "Examples:
  fredholm exercise --list
  fredholm exercise 10.1 --student ada
  fredholm exercise 10.1 --student ada --answer 0.64
  fredholm exercise 10.1 --student ada --hint
  fredholm exercise 10.1 --student ada --solution

The name of the student chooses the numbers of the question. The truth is computed for these numbers: from a closed form, or measured \
with its error. The answers are kept in fredholm-out/exercises/NAME.json. The solution is shown after a right answer or three wrong \
ones. Exit code 1: the answer is not right.";

/// Wrong answers after which the solution is shown.
const ENOUGH: usize = 3;

/// Arguments of `exercise`.
#[derive(Clone, Debug, Args)]
pub struct Options {
    /// Chapter and exercise: 10.1 [default: list them]
    #[arg(value_name = "N.M", help_heading = WHAT)]
    pub number: Option<String>,
    /// Any name; it chooses your numbers
    #[arg(long, value_name = "NAME", help_heading = WHAT)]
    pub student: Option<String>,
    /// Your answer: 0.64, 1/4, 25%, a word
    ///
    /// The question says which kind of answer it asks for. Without this option the question is printed.
    #[arg(long, value_name = "X", allow_hyphen_values = true, help_heading = WHAT)]
    pub answer: Option<String>,
    /// Print a hint
    #[arg(long, conflicts_with_all = ["answer", "solution", "list"], help_heading = WHAT)]
    pub hint: bool,
    /// Print the solution, after three tries
    #[arg(long, conflicts_with_all = ["answer", "list"], help_heading = WHAT)]
    pub solution: bool,
    /// List all exercises; with --student, mark those that are solved
    #[arg(long, conflicts_with = "answer", help_heading = WHAT)]
    pub list: bool,
    /// Folder for the answers [default: fredholm-out/exercises]
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT, value_hint = clap::ValueHint::DirPath)]
    pub out: Option<PathBuf>,
}

/// Asks, judges, helps or lists.
pub fn run(args: &Options) -> Result<Ending, Failure> {
    let student = args.student.as_deref().map(Student::new).transpose().map_err(unreadable)?;
    let folder = args.out.clone().unwrap_or_else(|| PathBuf::from("fredholm-out/exercises"));
    let tries = student.as_ref().map(|s| Tries::of(s, &folder)).transpose()?;
    let chapter_alone = args.number.as_deref().and_then(|word| CHAPTERS.iter().find(|c| word == c.number.to_string()));
    if args.number.is_none() && (args.answer.is_some() || args.hint || args.solution) {
        return Err(usage("which exercise?", "name it by its number: fredholm exercise 10.1 …"));
    }
    let Some(word) = args.number.as_deref().filter(|_| !args.list && chapter_alone.is_none()) else {
        return print(&list(chapter_alone, tries.as_ref())).map(|()| Ending::Ok);
    };
    let (chapter, exercise) = find(word)?;
    let number = format!("{}.{}", chapter.number, exercise.number);
    let (Some(student), Some(mut tries)) = (student, tries) else {
        let help = format!("any name will do: fredholm exercise {number} --student ada");
        return Err(usage("--student is missing; the name chooses your numbers", &help));
    };
    let line = format!("fredholm exercise {number} --student {}", quoted(student.name()));
    if args.hint {
        return print(&laid_out(exercise.hint)).map(|()| Ending::Ok);
    }
    if args.solution {
        let left = ENOUGH.saturating_sub(tries.wrong(&number));
        if left > 0 && !tries.solved(&number) {
            let what =
                format!("the solution of {number} is shown after a right answer or {}", counted(ENOUGH, "wrong one"));
            return Err(usage(&what, &format!("{line} --hint gives a hint; wrong answers left: {left}")));
        }
        return print(&laid_out(&(exercise.solution)(&student))).map(|()| Ending::Ok);
    }
    let Some(answer) = &args.answer else {
        return print(&question(chapter, exercise, &student, &line)).map(|()| Ending::Ok);
    };
    let judged = exercise.judge(&student, answer).map_err(|e| match e.downcast::<Unreadable>() {
        Ok(why) => unreadable(*why),
        Err(e) => Failure::input(&e.to_string()),
    })?;
    tries.add(Try { exercise: number.clone(), answer: answer.trim().into(), right: judged.right })?;
    let mut text = wrapped(&judged.says);
    if !judged.right {
        let wrong = tries.wrong(&number);
        let next = if wrong >= ENOUGH || tries.solved(&number) { "--solution" } else { "--hint" };
        text += &format!("\n\n{}\nNext: {line} {next}", said(wrong));
    }
    print(&text)?;
    Ok(if judged.right { Ending::Ok } else { Ending::Failed })
}

/// Text as a terminal shows it. A line with a command stays whole, so that it can be copied.
fn laid_out(text: &str) -> String {
    let line =
        |line: &str| if line.trim_start().starts_with("fredholm ") { line.trim_start().into() } else { wrapped(line) };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// The number of wrong answers so far, and when the solution is shown.
fn said(wrong: usize) -> String {
    let so_far = counted(wrong, "wrong answer");
    match ENOUGH.saturating_sub(wrong) {
        0 => format!("{so_far} so far. The solution is open."),
        left => format!("{so_far} so far. After {left} more the solution is open."),
    }
}

/// The question with the student's numbers, what is asked for, and how to answer.
fn question(chapter: &Chapter, exercise: &Exercise, student: &Student, line: &str) -> String {
    let head = format!("Exercise {}.{} for {}: {}", chapter.number, exercise.number, student.name(), exercise.title);
    let asks = format!("The answer is {}.", exercise.asks_for());
    format!(
        "{}\n\n{}\n\n{}\n{line} --answer X",
        wrapped(&head),
        laid_out(&(exercise.question)(student)),
        wrapped(&asks)
    )
}

/// All exercises, or those of one chapter.
fn list(only: Option<&Chapter>, tries: Option<&Tries>) -> String {
    let mut lines = vec![];
    for chapter in CHAPTERS.iter().filter(|c| only.is_none_or(|o| o.number == c.number)) {
        lines.push(format!("{:>2}  {}", chapter.number, chapter.title));
        for e in chapter.exercises {
            let number = format!("{}.{}", chapter.number, e.number);
            let mark = if tries.is_some_and(|t| t.solved(&number)) { '✓' } else { ' ' };
            lines.push(format!("  {mark} {number:<5} {}", wrapped_after(e.title, "          ")));
        }
    }
    lines.push("\nA question with your own numbers: fredholm exercise N.M --student NAME".into());
    lines.join("\n")
}

/// The exercise with a number such as 10.1.
fn find(word: &str) -> Result<(&'static Chapter, &'static Exercise), Failure> {
    let parts: Vec<Option<u32>> = word.split('.').map(|part| part.parse().ok()).collect();
    let list = "`fredholm exercise --list` lists the exercises";
    let [Some(n), Some(m)] = parts[..] else {
        let help = format!("write chapter and exercise, such as 10.1; {list}");
        return Err(usage(&format!("`{word}` is not the number of an exercise"), &help));
    };
    let Some(chapter) = CHAPTERS.iter().find(|c| c.number == n) else {
        return Err(usage(&format!("there is no chapter {n}, so there is no exercise {word}"), list));
    };
    chapter.exercises.iter().find(|e| e.number == m).map(|e| (chapter, e)).ok_or_else(|| {
        let numbers: Vec<String> = chapter.exercises.iter().map(|e| format!("{n}.{}", e.number)).collect();
        let has = if numbers.is_empty() { "none".into() } else { numbers.join(", ") };
        let help = format!("chapter {n} has {has}; the other exercises of its text are not judged");
        usage(&format!("there is no exercise {word}"), &help)
    })
}

fn unreadable(why: Unreadable) -> Failure {
    usage(&why.what, &why.help)
}

/// The word as it must be typed in a shell.
fn quoted(word: &str) -> String {
    shlex::try_quote(word).map_or(word.into(), |w| w.into_owned())
}
