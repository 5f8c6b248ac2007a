//! `fredholm slurm SCENE --shards N`: a script that renders the parts of a run on a Slurm cluster and merges them.

use super::base::{Ending, Failure, print, usage};
use super::keep::interval;
use super::open;
use super::options::{Changes, HOW, OUTPUT};
use super::output::{command_of, kept_words, quoted, without};
use super::solve::Solving;
use clap::Args;
use std::path::Path;

/// Below `slurm --help`.
pub const HELP: &str = "Examples:
  fredholm slurm cornell --spp 65536 --shards 8 > cornell.sh
  bash cornell.sh

Takes the options of `series` and prints a script; start it where sbatch is. It submits one array job with N tasks, and a job that merges \
their files once all have ended well. A task that is stopped, at its time limit or because its node is needed, keeps its state and is \
queued again; it goes on where it was stopped. A task that is finished is skipped, so the script may be started again.";

/// Arguments of `slurm`: those of `series`, which the parts get as they are, but for what the script chooses itself.
#[derive(Clone, Debug, Args)]
pub struct Slurm {
    /// What the parts solve, and how.
    #[command(flatten)]
    pub solving: Solving,
    /// Changes to the scene.
    #[command(flatten)]
    pub changes: Changes,
    /// How often a part keeps its state: 60s, 5m, off [default: 60s]
    #[arg(long, value_name = "TIME", value_parser = checkpoint, help_heading = OUTPUT, hide_short_help = true)]
    pub checkpoint: Option<String>,
    /// Number of parts, each a task of the array
    #[arg(long, value_name = "N", help_heading = HOW, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub shards: u32,
    /// CPUs of a task
    #[arg(long, value_name = "N", default_value_t = 1, help_heading = HOW, value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub cpus: u16,
    /// Time limit of a task, as sbatch takes it: 2:00:00
    ///
    /// [default: that of the partition]
    #[arg(long, value_name = "LIMIT", help_heading = HOW)]
    pub limit: Option<String>,
    /// Folder of the parts, the logs and the result [default: SCENE-parts]
    #[arg(long, value_name = "DIR", help_heading = OUTPUT)]
    pub folder: Option<String>,
}

fn checkpoint(text: &str) -> Result<String, String> {
    interval(text).map(|_| text.to_owned())
}

/// Prints the script.
pub fn run(args: &Slurm) -> Result<Ending, Failure> {
    if args.solving.pixels.time.is_some() {
        return Err(usage("parts need the same number of samples, and --time does not fix it", "use --spp"));
    }
    let own = ["--shards", "--cpus", "--limit", "--folder"];
    let mut words = without(&kept_words(), &own, &[]);
    if let Some(command) = words.iter_mut().find(|w| *w == "slurm") {
        *command = "series".into();
    }
    let stem = Path::new(&args.solving.frame.scene).file_stem().map_or("run".into(), |s| s.to_string_lossy());
    let name: String = stem.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' }).collect();
    let folder = args.folder.clone().unwrap_or_else(|| format!("{name}-parts"));
    if folder.contains(['\'', '\n', ',', '%'])
        || args.limit.as_ref().is_some_and(|l| l.contains(|c: char| c.is_whitespace()))
    {
        return Err(usage(
            "this name does not fit into a script",
            "choose a name without quotes, commas and %, and a limit such as 2:00:00",
        ));
    }
    // a scene that is not there would be found by every task
    open::description(&args.solving.frame.scene, &args.changes, args.solving.frame.size)?;
    print(&script(args, &name, &folder, &words))?;
    Ok(Ending::Ok)
}

fn script(args: &Slurm, name: &str, folder: &str, words: &[String]) -> String {
    let end = words.iter().position(|w| w == "--").unwrap_or(words.len());
    let (command, part) = (command_of(words), command_of(&words[..end]));
    let rest: String = words[end..].iter().map(|w| format!(" {}", quoted(w))).collect();
    let Slurm { shards, cpus, limit, .. } = args;
    let limit = limit.as_ref().map_or(String::new(), |l| format!("#SBATCH --time={l}\n"));
    let keep = args.checkpoint.as_ref().map_or(String::new(), |time| format!(" --checkpoint {time}"));
    format!(
        r#"#!/usr/bin/env bash
# {command}
# in {shards} parts, and their merge. Start it where sbatch is:  bash THIS-FILE
set -euo pipefail
folder='{folder}'
mkdir -p "$folder"
parts=$(sbatch --parsable --output="$folder/%a.log" --export=ALL,folder="$folder" <<'JOB'
#!/usr/bin/env bash
#SBATCH --job-name={name}
#SBATCH --array=1-{shards}
#SBATCH --cpus-per-task={cpus}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:TERM@60
{limit}# a minute before the limit comes SIGTERM: the part keeps its state (exit code 143) and is queued again
stop() {{ kill -TERM "$part" 2>/dev/null || true; }}
trap stop TERM
{part} --quiet{keep} \
  --shard "$SLURM_ARRAY_TASK_ID/{shards}" -t {cpus} -o "$folder/$SLURM_ARRAY_TASK_ID.fsh"{rest} &
part=$!
code=0
wait "$part" || code=$?
# a trapped signal ends `wait` before the part has ended
while kill -0 "$part" 2>/dev/null; do wait "$part" && code=0 || code=$?; done
if [ "$code" = 143 ]; then scontrol requeue "$SLURM_JOB_ID"; fi
exit "$code"
JOB
)
sbatch --dependency="afterok:$parts" --kill-on-invalid-dep=yes --output="$folder/merge.log" --export=ALL,folder="$folder" <<'JOB'
#!/usr/bin/env bash
#SBATCH --job-name={name}-merge
#SBATCH --cpus-per-task={cpus}
fredholm merge "$folder"/*.fsh -t {cpus} -o "$folder/merged"
JOB
"#
    )
}
