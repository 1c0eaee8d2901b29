//! `--resume`: long trainings go on after a kill.

use std::path::Path;
use std::time::Duration;

use kinesic_host::checkpoint::{Checkpoint, Keep};
use miette::{IntoDiagnostic, miette};

/// How a long training keeps what it has reached.
#[derive(Debug, clap::Args)]
pub struct ResumeArgs {
    /// Go on from the checkpoint that a stopped training has left beside the pack (NAME.checkpoint); without one, begin. The
    /// pack becomes the same, byte for byte
    #[arg(long)]
    resume: bool,
    /// Seconds between checkpoints; 0 = after every epoch or step
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, allow_negative_numbers = true)]
    checkpoint_every: f64,
}

/// A checkpoint that tells when it cannot be written.
pub struct Told(Checkpoint);

impl ResumeArgs {
    /// The checkpoint of the pack `out`, with what an earlier run has reached if that is wanted.
    pub fn checkpoint(&self, out: &Path, deciding: &[String]) -> miette::Result<Told> {
        let every = Duration::try_from_secs_f64(self.checkpoint_every).map_err(|_| {
            miette!("--checkpoint-every {}: expected seconds from 0 up, for example 10", self.checkpoint_every)
        })?;
        let mut checkpoint = Checkpoint::new(out, deciding, every);
        let path = checkpoint.path().display().to_string();
        if self.resume {
            let found = checkpoint.resume().into_diagnostic()?;
            eprintln!(
                "{path}: {}",
                if found { "going on from here" } else { "not there, training from the beginning" }
            );
        } else if checkpoint.path().exists() {
            eprintln!("{path}: left by a stopped training, not used: --resume would go on from it");
        }
        Ok(Told(checkpoint))
    }
}

impl Told {
    /// Removes the checkpoint: the pack is there.
    pub fn finish(self) {
        self.0.finish();
    }
}

impl Keep for Told {
    fn earlier(&mut self) -> Option<Vec<u8>> {
        self.0.earlier()
    }

    fn offer(&mut self, state: &dyn Fn() -> Vec<u8>) {
        self.0.offer(state);
        if let Some(error) = self.0.take_failure() {
            eprintln!("{}: cannot be written, training goes on without: {error}", self.0.path().display());
        }
    }
}
