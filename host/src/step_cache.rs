//! What a training of many independent steps has reached: each step's result by name, so that none is done twice.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::checkpoint::Keep;

/// Results of steps that are done. Steps may run on many threads; a step's result must depend on its name and the training alone.
pub struct StepCache<'k> {
    inner: Mutex<Inner<'k>>,
}

struct Inner<'k> {
    done: BTreeMap<String, Vec<f64>>,
    keep: Option<&'k mut (dyn Keep + Send)>,
}

/// A checkpoint whose content is not understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the checkpoint holds no steps of this training: remove it to train from the beginning")]
pub struct Unreadable;

impl StepCache<'static> {
    /// Nothing yet, and nothing is kept.
    pub fn nothing() -> Self {
        Self { inner: Mutex::new(Inner { done: BTreeMap::new(), keep: None }) }
    }
}

impl<'k> StepCache<'k> {
    /// What an earlier run has kept in `keep`, where this one keeps more.
    pub fn new(keep: &'k mut (dyn Keep + Send)) -> Result<Self, Unreadable> {
        let done = match keep.earlier() {
            Some(bytes) => postcard::from_bytes(&bytes).map_err(|_| Unreadable)?,
            None => BTreeMap::new(),
        };
        Ok(Self { inner: Mutex::new(Inner { done, keep: Some(keep) }) })
    }

    /// Refuses what an earlier run has kept unless every step, by name and result, could be one of this training.
    pub fn check(&self, fits: impl Fn(&str, &[f64]) -> bool) -> Result<(), Unreadable> {
        if self.lock().done.iter().all(|(name, result)| fits(name, result)) { Ok(()) } else { Err(Unreadable) }
    }

    /// The result of the step `name`: as it is known, or from `work`.
    pub fn once<E>(&self, name: &str, work: impl FnOnce() -> Result<Vec<f64>, E>) -> Result<Vec<f64>, E> {
        if let Some(known) = self.lock().done.get(name) {
            return Ok(known.clone());
        }
        let found = work()?;
        let mut inner = self.lock();
        let Inner { done, keep } = &mut *inner;
        done.insert(name.to_owned(), found.clone());
        if let Some(keep) = keep {
            // Writing to a growing vector has no way to fail.
            keep.offer(&|| postcard::to_allocvec(done).unwrap_or_default());
        }
        Ok(found)
    }

    /// [`once`](Self::once) for a step that cannot fail.
    pub fn always(&self, name: &str, work: impl FnOnce() -> Vec<f64>) -> Vec<f64> {
        self.once::<Infallible>(name, || Ok(work())).unwrap_or_else(|never| match never {})
    }

    /// [`once`](Self::once) for a step whose result is one number.
    pub fn number<E>(&self, name: &str, work: impl FnOnce() -> Result<f64, E>) -> Result<f64, E> {
        Ok(self.once(name, || Ok(vec![work()?]))?.first().copied().unwrap_or(f64::NAN))
    }

    fn lock(&self) -> MutexGuard<'_, Inner<'k>> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Memory(Option<Vec<u8>>);

    impl Keep for Memory {
        fn earlier(&mut self) -> Option<Vec<u8>> {
            self.0.clone()
        }

        fn offer(&mut self, state: &dyn Fn() -> Vec<u8>) {
            self.0 = Some(state());
        }
    }

    #[test]
    fn a_step_is_done_once_and_a_failure_is_not_kept() {
        let mut memory = Memory::default();
        {
            let cache = StepCache::new(&mut memory).unwrap();
            assert_eq!(cache.always("a", || vec![1.0, f64::NAN])[0], 1.0);
            assert_eq!(cache.number("b", || Err::<f64, _>("no")), Err("no"));
            assert_eq!(cache.number("b", || Ok::<_, ()>(0.1 + 0.2)), Ok(0.1 + 0.2));
        }
        let cache = StepCache::new(&mut memory).unwrap();
        assert!(cache.always("a", || unreachable!())[1].is_nan());
        assert_eq!(cache.number::<()>("b", || unreachable!()), Ok(0.1 + 0.2));
        let mut other = Memory(Some(vec![200, 1, 7]));
        assert!(StepCache::new(&mut other).is_err());
    }
}
