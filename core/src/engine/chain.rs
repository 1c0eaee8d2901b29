//! Engines one after the other, and engines that may be missing.

use super::{Engine, FromPack, Mix};
use crate::model::{LoadError, Pack};
use crate::rig::Frame;

macro_rules! chain {
    ($($engine:ident . $index:tt),+) => {
        impl<const ROWS: usize, $($engine: Engine<ROWS>),+> Engine<ROWS> for ($($engine,)+) {
            type State = ($($engine::State,)+);

            fn start(&self, state: &mut Self::State, frame: &Frame<ROWS>) {
                // What comes later starts from what those before make of the frame, but for what stands where the machine does.
                let mut made = *frame;
                $(
                    if $engine::STANDS {
                        self.$index.start(&mut state.$index, frame);
                    } else {
                        self.$index.start(&mut state.$index, &made);
                        self.$index.step(&mut state.$index, &mut made);
                    }
                )+
            }

            fn step(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
                $(self.$index.step(&mut state.$index, frame);)+
            }

            fn idle(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
                $(self.$index.idle(&mut state.$index, frame);)+
            }
        }

        impl<'a, $($engine: FromPack<'a>),+> FromPack<'a> for ($($engine,)+) {
            fn from_pack(pack: &Pack<'a>) -> Result<Self, LoadError> {
                Ok(($($engine::from_pack(pack)?,)+))
            }
        }

        impl<'a, $($engine: FromPack<'a>),+> FromPack<'a> for Mix<($($engine,)+)> {
            fn from_pack(pack: &Pack<'a>) -> Result<Self, LoadError> {
                FromPack::from_pack(pack).map(Mix)
            }
        }
    };
}

chain!(A.0);
chain!(A.0, B.1);
chain!(A.0, B.1, C.2);
chain!(A.0, B.1, C.2, D.3);

impl<const ROWS: usize, E: Engine<ROWS>> Engine<ROWS> for Option<E> {
    type State = E::State;
    const STANDS: bool = E::STANDS;

    fn start(&self, state: &mut Self::State, frame: &Frame<ROWS>) {
        if let Some(engine) = self {
            engine.start(state, frame);
        }
    }

    fn step(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
        if let Some(engine) = self {
            engine.step(state, frame);
        }
    }

    fn idle(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
        if let Some(engine) = self {
            engine.idle(state, frame);
        }
    }
}

impl<'a, E: FromPack<'a>> FromPack<'a> for Option<E> {
    fn from_pack(pack: &Pack<'a>) -> Result<Self, LoadError> {
        match E::from_pack(pack) {
            Ok(engine) => Ok(Some(engine)),
            Err(LoadError::NoModel { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }
}

/// Nothing at all: the source passes.
impl<const ROWS: usize> Engine<ROWS> for () {
    type State = ();
    fn start(&self, (): &mut (), _: &Frame<ROWS>) {}
    fn step(&self, (): &mut (), _: &mut Frame<ROWS>) {}
}

impl<'a> FromPack<'a> for () {
    fn from_pack(_: &Pack<'a>) -> Result<Self, LoadError> {
        Ok(())
    }
}
