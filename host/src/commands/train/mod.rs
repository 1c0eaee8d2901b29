//! `kinesic train`: one file an engine.

mod components;
mod emotion;
mod face;
mod mechanics;
mod report;
mod resume;
mod session;
mod translate;

use clap::Subcommand;

/// Train a model from clips and pack it
#[derive(Debug, Subcommand)]
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
