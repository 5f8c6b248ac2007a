//! The output folder: the same command replaces its own output, another run's is never overwritten without `--force`, and an input
//! never at all.

use super::base::Failure;
use super::claim::{self, Claim, Denied};
use fredholm::report::text::summary;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Who may write into an output folder.
pub struct Owner<'a> {
    /// The command of the run.
    pub command: &'a str,
    /// Replace another run's output.
    pub force: bool,
    /// Files that the command reads, and folders of results.
    pub inputs: &'a [PathBuf],
    /// Go on with the run of a folder for which this is true.
    pub resumes: &'a dyn Fn(&Path) -> bool,
}

/// The output folder of this command, claimed for this process: it holds nothing of another run and none of the inputs.
pub fn folder(asked: Option<&Path>, name: &str, owner: &Owner<'_>) -> Result<(PathBuf, Claim), Failure> {
    let Owner { command, force, inputs, resumes } = owner;
    if let Some(dir) = asked {
        if dir.exists() && !dir.is_dir() {
            return Err(Failure::at(dir, "the output folder is a file", "choose another with -o"));
        }
        if let Some(input) = inputs.iter().find(|input| is_in(input, dir)) {
            let what = format!("the output folder holds an input, {}", input.display());
            return Err(Failure::at(dir, &what, "choose another with -o"));
        }
        if claim::stays_taken(dir) {
            return Err(taken(dir));
        }
        if !force && !ours(dir, command) && !resumes(dir) {
            let help = "choose another with -o, or replace it with --force";
            return Err(Failure::at(dir, "the output folder holds another run's output", help));
        }
        return match claimed(dir, command)? {
            Some(claim) => Ok((dir.to_path_buf(), claim)),
            None => Err(taken(dir)),
        };
    }
    let base = PathBuf::from("fredholm-out");
    let folders = || std::iter::once(base.join(name)).chain((2..).map(|i| base.join(format!("{name}-{i}"))));
    // the first folder of a run that can go on comes before an empty one
    let going_on = folders().take_while(|dir| dir.exists()).find(|dir| resumes(dir));
    let free = |dir: &PathBuf| (*force || ours(dir, command)) && !inputs.iter().any(|input| is_in(input, dir));
    if let Some(dir) = going_on {
        return claimed(&dir, command)?.map(|claim| (dir.clone(), claim)).ok_or_else(|| taken(&dir));
    }
    for dir in folders().filter(free) {
        if let Some(claim) = claimed(&dir, command)? {
            return Ok((dir, claim));
        }
    }
    Err(Failure::at(&base, "no folder is free", "choose one with -o"))
}

/// Makes and claims a folder. None if another run has it. Finds a folder that cannot be written before the render, not after it.
fn claimed(dir: &Path, command: &str) -> Result<Option<Claim>, Failure> {
    let claim = std::fs::create_dir_all(dir).map_err(Denied::Failed).and_then(|()| Claim::folder(dir, command));
    match claim {
        Ok(claim) => Ok(Some(claim)),
        Err(Denied::Taken) => Ok(None),
        Err(Denied::Failed(e)) => {
            Err(Failure::at(dir, &format!("cannot write into the output folder: {e}"), "choose another with -o"))
        }
    }
}

/// True if an input, a file or the folder of a result, would be among the files of an output folder.
fn is_in(input: &Path, dir: &Path) -> bool {
    let [input, dir] = [input, dir].map(|p| p.canonicalize().ok());
    input.zip(dir).is_some_and(|(input, dir)| if input.is_dir() { input == dir } else { input.parent() == Some(&dir) })
}

fn taken(dir: &Path) -> Failure {
    let help = "wait until it ends, or choose another with -o";
    Failure::at(dir, "another run is writing into the output folder", help)
}

/// Returns true if a folder is empty, absent, the output of the same command, or where the same command was killed.
fn ours(dir: &Path, command: &str) -> bool {
    let Ok(mut files) = std::fs::read_dir(dir) else { return !dir.exists() };
    let trace = |name: &OsStr| name.to_str().is_some_and(claim::is_trace);
    files.all(|file| file.is_ok_and(|f| trace(&f.file_name())))
        || summary::read(&dir.join("summary.json")).is_ok_and(|s| s.command == command)
        || claim::left_behind(dir).is_some_and(|killed| killed == command)
}

/// The files of the last run in this folder, from its summary.
pub fn left_by_the_last_run(folder: &Path) -> Vec<String> {
    summary::read(&folder.join("summary.json")).map_or(vec![], |s| s.files)
}

/// Removes files of the last run that this run did not replace, so that a folder never shows two results.
pub fn remove_stale(folder: &Path, old: &[String], new: &[String]) {
    let plain = |name: &&String| Path::new(name).file_name().is_some_and(|n| n == name.as_str());
    for name in old.iter().filter(|n| !new.contains(n)).filter(plain) {
        // a file that cannot be removed may be gone already; the new files are complete either way
        let _ = std::fs::remove_file(folder.join(name));
    }
}

/// The command line without options that do not change the result, such as `--out` and `--threads`.
pub fn canonical_command() -> String {
    command_of(&kept_words())
}

/// The words of that command line, without the name of the program.
pub fn kept_words() -> Vec<String> {
    let words: Vec<String> = std::env::args_os().skip(1).map(|a| a.to_string_lossy().into_owned()).collect();
    without(&words, &WITH_VALUE, &ALONE)
}

/// A command line of its words.
pub fn command_of(words: &[String]) -> String {
    std::iter::once("fredholm".into()).chain(words.iter().map(|w| quoted(w))).collect::<Vec<_>>().join(" ")
}

/// The words with more options, before a `--` that ends the options.
pub fn with_options(words: &[String], options: &[&str]) -> Vec<String> {
    let end = words.iter().position(|w| w == "--").unwrap_or(words.len());
    let options = options.iter().map(|o| (*o).to_owned());
    words[..end].iter().cloned().chain(options).chain(words[end..].iter().cloned()).collect()
}

/// A command without the options that a resumed run may change.
pub fn but_for_samples(words: &[String]) -> Vec<String> {
    without(words, &["--spp", "--time"], &[])
}

/// Options that do not change the result, with a value and alone.
const WITH_VALUE: [&str; 4] = ["--out", "--threads", "--checkpoint", "--shard"];
const ALONE: [&str; 5] = ["--force", "--json", "--quiet", "--verbose", "--resume"];

/// The words without some long options; and without `-q`, `-v`, `-o` and `-t`, which do not change the result either.
pub fn without(args: &[String], with_value: &[&str], alone: &[&str]) -> Vec<String> {
    let mut words = vec![];
    let mut args = args.iter();
    while let Some(arg) = args.next() {
        if arg == "--" {
            words.extend(std::iter::once(arg).chain(args.by_ref()).cloned());
        } else if let Some(cluster) = arg.strip_prefix('-').filter(|a| !a.is_empty() && !a.starts_with('-')) {
            // -q and -v stand alone; -o and -t take the rest of the word, or else the next one
            if cluster.trim_start_matches(['q', 'v']).len() == 1 {
                args.next();
            }
        } else if with_value.contains(&arg.as_str()) {
            args.next();
        } else if !alone.contains(&arg.as_str()) && !with_value.iter().any(|n| arg.starts_with(&format!("{n}="))) {
            words.push(arg.clone());
        }
    }
    words
}

/// A word as a shell reads it.
pub fn quoted(arg: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_=.,:@/+".contains(c);
    if !arg.is_empty() && arg.chars().all(plain) {
        arg.to_string()
    } else {
        format!("'{}'", arg.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::{ALONE, WITH_VALUE, but_for_samples, command_of, without};

    #[test]
    fn what_does_not_change_the_result_is_no_part_of_the_command() {
        let words = |line: &str| -> Vec<String> { line.split(' ').map(String::from).collect() };
        let of = |line: &str| command_of(&without(&words(line), &WITH_VALUE, &ALONE));
        let same = [
            "series a.toml --spp 4",
            "series -o x a.toml --spp 4",
            "series -ox a.toml --spp 4 -t2",
            "series -qvo x a.toml --spp 4 -vt 2",
            "series --out=x a.toml --threads 2 --spp 4 --force --json --quiet --verbose",
            "series --out x a.toml -o=x --spp 4 -q",
            "series --shard 3/8 a.toml --spp 4 --checkpoint=5s --resume",
        ];
        for line in same {
            assert_eq!(of(line), "fredholm series a.toml --spp 4", "{line}");
        }
        assert_eq!(of("series -q -- -o.toml"), "fredholm series -- -o.toml");
        assert_eq!(of("info a[0].toml"), "fredholm info 'a[0].toml'");
        assert_eq!(
            but_for_samples(&words("series a.toml --spp 4 --seed 1 --time=3s")),
            words("series a.toml --seed 1")
        );
    }
}
