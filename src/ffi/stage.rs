//! The base of all stages, which are objects that compute a result in a job. A stage has inputs that change only
//! between jobs, runs one job at a time, and stores the result of a job that has succeeded.

use super::context::Context;
use super::guard::lock;
use super::handle::{self, Owned};
use super::job::{Job, luxfer_job};
use super::pointer::Out;
use crate::error::{Error, ErrorKind, Result};
use std::sync::{Arc, Mutex};

/// A stage, such as a segmentation or a rendering: its jobs compute a result `O` from inputs `I`.
pub(super) struct Stage<I, O> {
    context: Arc<Context>,
    state: Mutex<StageState<I, O>>,
}

struct StageState<I, O> {
    busy: bool,
    inputs: I,
    output: Option<Arc<O>>,
}

impl<I, O> Owned for Stage<I, O> {
    fn context(&self) -> &Arc<Context> {
        &self.context
    }
}

impl<I: Clone + Send + 'static, O: Send + Sync + 'static> Stage<I, O> {
    pub(super) fn new(context: &Arc<Context>, inputs: I) -> Arc<Self> {
        Arc::new(Self { context: context.clone(), state: Mutex::new(StageState { busy: false, inputs, output: None }) })
    }

    /// Changes the inputs; an error while a job runs. If `change` fails, it must leave the inputs as they were.
    pub(super) fn change(&self, change: impl FnOnce(&mut I) -> Result<()>) -> Result<()> {
        let state = &mut *lock(&self.state);
        state.check_idle()?;
        change(&mut state.inputs)
    }

    /// Returns a copy of the current inputs.
    pub(super) fn inputs(&self) -> I {
        lock(&self.state).inputs.clone()
    }

    /// Returns the latest result; an error if there is none yet.
    pub(super) fn output(&self) -> Result<Arc<O>> {
        lock(&self.state).output.clone().ok_or_else(|| {
            Error::new(ErrorKind::NotReady, "there is no result yet; start the stage and wait for its job to succeed")
        })
    }

    /// Stores a result: an intermediate one while the job runs, or the final one when the job has succeeded.
    pub(super) fn publish(&self, output: O) {
        lock(&self.state).output = Some(Arc::new(output));
    }

    /// Changes a part of the result, for example to use an image that the caller supplies; an error while a job runs.
    pub(super) fn replace(&self, change: impl FnOnce(&mut O)) -> Result<()>
    where
        O: Clone + Default,
    {
        let state = &mut *lock(&self.state);
        state.check_idle()?;
        change(Arc::make_mut(state.output.get_or_insert_default()));
        Ok(())
    }

    /// Starts a job on a copy of the current inputs. If the job succeeds, its result becomes the result of the stage.
    pub(super) fn start(
        self: &Arc<Self>,
        place: *mut *mut luxfer_job,
        work: impl FnOnce(&I, &Self, crate::job::Job) -> Result<O> + Send + 'static,
    ) -> Result<()> {
        let out = Out::new(place, "job")?;
        let inputs = {
            let state = &mut *lock(&self.state);
            state.check_idle()?;
            state.busy = true;
            state.inputs.clone()
        };
        // The claim keeps the stage busy. It is dropped when the job ends, and also if the job's thread cannot be
        // started.
        let claim = Claim(self.clone());
        let job = Job::start(&self.context, move |job| {
            let output = work(&inputs, &claim.0, job)?;
            claim.0.publish(output);
            Ok(())
        })?;
        out.set(handle::give(Arc::new(job)));
        Ok(())
    }
}

/// Claims several stages for one job: none of them may be busy, or be named twice. If one cannot be claimed, the claims
/// of the others are dropped.
pub(super) fn claim_all<I, O>(stages: &[Arc<Stage<I, O>>], name: &str) -> Result<Claims<I, O>> {
    let mut claims = Vec::with_capacity(stages.len());
    for (k, stage) in stages.iter().enumerate() {
        if let Some(first) = stages[..k].iter().position(|other| Arc::ptr_eq(other, stage)) {
            return Err(Error::argument(format!("{name}[{k}] is {name}[{first}] too; each may be named once")));
        }
        let state = &mut *lock(&stage.state);
        state.check_idle().map_err(|e| e.context(format_args!("{name}[{k}]")))?;
        state.busy = true;
        claims.push(Claim(stage.clone()));
    }
    Ok(Claims(claims))
}

/// Several stages that one job keeps busy.
pub(super) struct Claims<I, O>(Vec<Claim<I, O>>);

impl<I: Clone + Send + 'static, O: Send + Sync + 'static> Claims<I, O> {
    /// Starts a job that gets the stages and publishes their results.
    pub(super) fn start(
        self,
        context: &Arc<Context>,
        place: *mut *mut luxfer_job,
        work: impl FnOnce(&dyn Fn(usize, O), crate::job::Job) -> Result<()> + Send + 'static,
    ) -> Result<()> {
        let out = Out::new(place, "job")?;
        let job = Job::start(context, move |job| work(&|k, output| self.0[k].0.publish(output), job))?;
        out.set(handle::give(Arc::new(job)));
        Ok(())
    }
}

impl<I, O> StageState<I, O> {
    fn check_idle(&self) -> Result<()> {
        if self.busy {
            return Err(Error::new(
                ErrorKind::InvalidOperation,
                "a job is running on this object; wait for it or cancel it first",
            ));
        }
        Ok(())
    }
}

struct Claim<I, O>(Arc<Stage<I, O>>);

impl<I, O> Drop for Claim<I, O> {
    fn drop(&mut self) {
        lock(&self.0.state).busy = false;
    }
}

/// Returns a required input of a job; an error that names `setter` if the input is missing.
pub(super) fn need<'a, T>(input: &'a Option<T>, setter: &str) -> Result<&'a T> {
    input
        .as_ref()
        .ok_or_else(|| Error::new(ErrorKind::InvalidOperation, format!("an input is missing: call {setter} first")))
}
