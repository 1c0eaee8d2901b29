//! The subcommands. Each file reads its arguments, calls the library and prints.

#[macro_use]
mod print;

mod angles;
mod apply;
mod batch;
mod blend;
mod clips;
mod completions;
mod decouple;
mod demo;
mod edit;
mod eval;
mod export;
mod expression;
mod face;
mod figure;
mod guard;
mod inspect;
mod land;
mod limits;
mod mask;
mod mix;
mod modulate;
mod origin;
mod output;
mod pictures;
mod precision;
mod quality;
mod quantize;
mod robot;
mod score;
mod sheet;
mod suggest;
mod synth;
mod train;
mod view;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

/// Learn how a motion is performed on a workstation; perform it frame by frame on a microcontroller.
///
/// Without a subcommand the demo runs: two made-up manners of walking, a trained translator, and a walk that it has not seen.
#[derive(Debug, Parser)]
#[command(name = "kinesic", version, after_help = format!("{EXAMPLES}\n\n{}", train::CHOOSE))]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    /// Write even over a file that this command reads, or twice to one file
    #[arg(long, global = true)]
    overwrite: bool,
    /// Leave paths and command lines out of packs and pages; names of files and their digests stay
    #[arg(long, global = true)]
    private: bool,
}

const EXAMPLES: &str = "\
Examples:
  kinesic demo
  kinesic inspect walk.bvh
  kinesic train translate --pair neutral.bvh angry.bvh --out angry.kin
  kinesic apply angry.kin walk.bvh --out angry-walk.bvh --strength 0.8 --mask Head=0
  kinesic eval translate angry.kin --pair neutral2.bvh angry2.bvh";

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::Args),
    Inspect(inspect::Args),
    #[command(subcommand)]
    Train(train::Engine),
    Apply(apply::Args),
    #[command(subcommand)]
    Eval(eval::Engine),
    Decouple(decouple::Args),
    Modulate(modulate::Args),
    Mix(mix::Args),
    Blend(blend::Args),
    View(view::Args),
    Quantize(quantize::Args),
    Score(score::Args),
    Sheet(sheet::Args),
    #[command(subcommand)]
    Robot(robot::Action),
    Limits(limits::Args),
    Edit(edit::Args),
    Export(export::Args),
    Completions(completions::Args),
    Face(face::Args),
    Synth(synth::Args),
}

/// Runs the command line of the process.
///
/// What was assumed about the clips is said on standard error, unless JSON carries it, also where the command fails.
pub fn run() -> miette::Result<()> {
    let matches = Cli::command().get_matches();
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    guard::set_overwrites(cli.overwrite);
    if !cli.overwrite {
        guard::check(&matches)?;
    }
    origin::keep_private(cli.private);
    let done = dispatch(cli);
    for note in clips::NOTES.take() {
        eprintln!("note: {note}");
    }
    done
}

fn dispatch(cli: Cli) -> miette::Result<()> {
    match cli.command.unwrap_or_else(|| Command::Demo(demo::Args::default())) {
        Command::Demo(args) => demo::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Train(engine) => train::run(&engine),
        Command::Apply(args) => apply::run(&args),
        Command::Eval(engine) => eval::run(&engine),
        Command::Decouple(args) => decouple::run(&args),
        Command::Modulate(args) => modulate::run(&args),
        Command::Mix(args) => mix::run(&args),
        Command::Blend(args) => blend::run(&args),
        Command::View(args) => view::run(&args),
        Command::Quantize(args) => quantize::run(&args),
        Command::Score(args) => score::run(&args),
        Command::Sheet(args) => sheet::run(&args),
        Command::Robot(action) => robot::run(&action),
        Command::Limits(args) => limits::run(&args),
        Command::Edit(args) => edit::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Completions(args) => completions::run(&args),
        Command::Face(args) => face::run(&args),
        Command::Synth(args) => synth::run(&args),
    }
}

/// Prints why a command failed.
pub fn complain(report: &miette::Report) {
    print::failure(report);
}
