//! Work on threads of the package. The caller waits without the interpreter, so that other Python threads run,
//! looks for signals, and answers what the work asks. A panic becomes an exception.
//!
//! Each call under way has a pool of its own, from a list of free ones. So calls wait neither for each other nor
//! for a callback of another, and a thread that waits in a pool can begin only work of its own call.

use crate::errors::internal;
use flexbody::Interrupt;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Time between two looks for signals, and for the end of interrupted work.
const LOOK: Duration = Duration::from_millis(50);
const END: Duration = Duration::from_millis(500);
/// Beginning of the names of the threads, and the memory for the stack of one.
const NAME: &str = "flexbody";
const STACK: usize = 16 << 20;
/// Most threads of a pool, and most pools that wait for a call.
const MOST_THREADS: usize = 4096;
const MOST_FREE: usize = 8;

/// The free pools of this process. A forked process has none of its parent's threads.
struct Pools {
    process: u32,
    count: usize,
    free: Vec<Arc<ThreadPool>>,
}

static POOLS: Mutex<Pools> = Mutex::new(Pools {
    process: 0,
    count: 0,
    free: Vec::new(),
});

/// The list of free pools, without those of a parent process.
fn pools() -> MutexGuard<'static, Pools> {
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if pools.process != process {
        // The threads of a parent cannot be joined here.
        std::mem::forget(std::mem::take(&mut pools.free));
        pools.process = process;
    }
    pools
}

/// A free pool, or a new one.
fn take() -> Result<Arc<ThreadPool>, String> {
    let (free, count) = {
        let mut pools = pools();
        (pools.free.pop(), pools.count)
    };
    if let Some(pool) = free {
        return Ok(pool);
    }
    let named = |k| format!("{NAME}-{k}");
    let builder = ThreadPoolBuilder::new().num_threads(count);
    let made = builder.thread_name(named).stack_size(STACK).build();
    Ok(Arc::new(
        made.map_err(|error| format!("no threads: {error}"))?,
    ))
}

/// Gives a pool back, unless there are many or its number of threads is no longer wanted.
fn give(pool: Arc<ThreadPool>) {
    let mut pools = pools();
    let wanted = pools.count == 0 || pools.count == pool.current_num_threads();
    if wanted && pools.free.len() < MOST_FREE {
        pools.free.push(pool);
    }
}

/// Sets the number of threads from the next call on; 0 is one for each processor.
#[pyfunction]
pub(crate) fn set_threads(count: usize) -> PyResult<()> {
    if count > MOST_THREADS {
        let what = format!("found {count} threads, expected at most {MOST_THREADS}");
        return Err(PyValueError::new_err(what));
    }
    let mut pools = pools();
    pools.count = count;
    pools.free.clear();
    Ok(())
}

/// The number of threads.
#[pyfunction]
pub(crate) fn threads(py: Python<'_>) -> PyResult<usize> {
    let pool = take().map_err(|what| internal(py, &what))?;
    let count = pool.current_num_threads();
    give(pool);
    Ok(count)
}

/// Panics on the threads of the package print nothing: they become exceptions.
pub(crate) fn silence_panics() {
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let thread = std::thread::current();
        if !thread.name().is_some_and(|name| name.starts_with(NAME)) {
            before(panic);
        }
    }));
}

fn text_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "no message".to_owned())
}

/// What interrupts the calls of a problem, and how many are under way.
#[derive(Clone, Default)]
pub(crate) struct Stop {
    pub interrupt: Interrupt,
    running: Arc<AtomicUsize>,
}

impl Stop {
    /// Whether the calls under way must end.
    pub fn has_come(&self) -> bool {
        self.interrupt.has_stopped()
    }

    /// Forgets the calls of a parent process.
    pub fn forget_calls(&self) {
        self.running.store(0, Ordering::SeqCst);
    }

    fn begin(&self) {
        self.running.fetch_add(1, Ordering::SeqCst);
    }

    /// The last call lets others begin again.
    fn end(&self) {
        if self.running.fetch_sub(1, Ordering::SeqCst) == 1 {
            self.interrupt.reset();
        }
    }
}

/// What the work tells its caller.
enum Message<M, T> {
    /// On its way.
    Event(M),
    /// At its end, or how it panicked.
    End(Result<T, String>),
}

/// Work under way.
pub(crate) struct Running<M, T> {
    receiver: Receiver<Message<M, T>>,
    stop: Stop,
}

/// Starts `work` on a pool. It sends messages by the function that it is given.
pub(crate) fn start<M: Send + 'static, T: Send + 'static>(
    py: Python<'_>,
    stop: &Stop,
    work: impl FnOnce(&dyn Fn(M)) -> T + Send + 'static,
) -> PyResult<Running<M, T>> {
    let (sender, receiver) = channel();
    let own = stop.clone();
    let pool = take().map_err(|what| internal(py, &what))?;
    let kept = pool.clone();
    own.begin();
    pool.spawn(move || {
        let tell = |event| {
            // A caller that has given up needs no messages.
            let _ = sender.send(Message::Event(event));
        };
        let done = catch_unwind(AssertUnwindSafe(|| work(&tell)));
        own.end();
        give(kept);
        let _ = sender.send(Message::End(done.map_err(|panic| text_of(&*panic))));
    });
    Ok(Running {
        receiver,
        stop: stop.clone(),
    })
}

impl<M: Send, T: Send> Running<M, T> {
    /// Waits for the end. `on_event` is called with the interpreter; after an exception of it the work is
    /// expected to end by itself. A signal ends the work, which then has half a second, and is raised.
    pub fn wait(self, py: Python<'_>, mut on_event: impl FnMut(M) -> PyResult<()>) -> PyResult<T> {
        // A receiver is used by one thread, but not always by the same.
        let receiver = Mutex::new(self.receiver);
        let next = |time: Duration| {
            let wait = || match receiver.lock() {
                Ok(receiver) => receiver.recv_timeout(time),
                Err(_) => Err(RecvTimeoutError::Disconnected),
            };
            py.detach(wait)
        };
        let mut raised: Option<(PyErr, Instant)> = None;
        loop {
            let looked = match next(LOOK) {
                Ok(Message::End(done)) => {
                    if let Some((error, _)) = raised {
                        return Err(error);
                    }
                    // A signal that came with the end is not lost.
                    py.check_signals()?;
                    return done.map_err(|panic| internal(py, &panic));
                }
                // What comes after an exception has no answer.
                Ok(Message::Event(_)) if raised.is_some() => Ok(()),
                Ok(Message::Event(event)) => match on_event(event) {
                    Ok(()) => Ok(()),
                    Err(error) => {
                        raised = Some((error, Instant::now() + END));
                        continue;
                    }
                },
                Err(RecvTimeoutError::Timeout) => Ok(()),
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(internal(py, "the thread of the work is gone"));
                }
            };
            if let Err(error) = looked.and_then(|()| py.check_signals()) {
                self.stop.interrupt.stop();
                let (error, _) = raised.unwrap_or((error, Instant::now()));
                raised = Some((error, Instant::now() + END));
            }
            match raised {
                // What goes on is stopped; its result is lost.
                Some((error, deadline)) if Instant::now() >= deadline => {
                    self.stop.interrupt.stop();
                    return Err(error);
                }
                other => raised = other,
            }
        }
    }
}

/// Does `work` on a thread and waits for it.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    stop: &Stop,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    start(py, stop, move |_: &dyn Fn(())| work())?.wait(py, |()| Ok(()))
}

/// Panics on a thread of the package, for the test of what becomes of it.
#[pyfunction]
#[pyo3(name = "_panic")]
pub(crate) fn panic_on_purpose(py: Python<'_>) -> PyResult<()> {
    run(py, &Stop::default(), || panic!("on purpose"))
}
