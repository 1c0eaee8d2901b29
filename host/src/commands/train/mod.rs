//! `kinesic train`: one file an engine.

mod components;
mod doubtful;
mod emotion;
mod face;
mod learned;
mod mechanics;
mod report;
mod resume;
mod session;
mod translate;

use clap::Subcommand;

/// Which engine when.
pub const CHOOSE: &str = "\
You have                                                     use
  pairs of clips: the same thing done in two manners         train translate
  a clip, and one in another manner that is no pair          train components
  labelled clips of one action; a dial per mood              train emotion, then synth
  plain clips of a body; more or less of what is expressive  train mechanics, then modulate, mix, blend
  a robot's own moves in two manners                         train translate --robot
  68 landmarks of faces, and how strongly they smile         train face
What each keeps, costs and cannot do: docs/choose.md";

/// Train a model from clips and pack it
#[derive(Debug, Subcommand)]
#[command(after_help = CHOOSE)]
pub enum Engine {
    Translate(translate::Args),
    Mechanics(mechanics::Args),
    Components(components::Args),
    Emotion(emotion::Args),
    Face(face::Args),
}

/// Runs the command.
pub fn run(engine: &Engine) -> miette::Result<()> {
    match engine {
        Engine::Translate(args) => translate::run(args),
        Engine::Mechanics(args) => mechanics::run(args),
        Engine::Components(args) => components::run(args),
        Engine::Emotion(args) => emotion::run(args),
        Engine::Face(args) => face::run(args),
    }
}
