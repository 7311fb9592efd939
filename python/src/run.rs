//! Work on the threads of the package. The caller waits without the interpreter, so that other Python threads
//! run, and looks for signals. A panic becomes an exception.

use crate::errors::internal;
use flexbody::Interrupt;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two looks for signals, and for the end of interrupted work.
const LOOK: Duration = Duration::from_millis(50);
const END: Duration = Duration::from_millis(500);
/// Beginning of the names of the threads.
const NAME: &str = "flexbody";

/// The threads of this process. A forked process has none of its parent's.
struct Pool {
    process: u32,
    count: usize,
    threads: Option<Arc<ThreadPool>>,
}

static POOL: Mutex<Pool> = Mutex::new(Pool {
    process: 0,
    count: 0,
    threads: None,
});

fn pool() -> Result<Arc<ThreadPool>, String> {
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if pool.process != process {
        // The threads of a parent cannot be joined here.
        std::mem::forget(pool.threads.take());
        pool.process = process;
    }
    if let Some(threads) = &pool.threads {
        return Ok(threads.clone());
    }
    let named = |k| format!("{NAME}-{k}");
    let builder = ThreadPoolBuilder::new().num_threads(pool.count);
    let made = builder.thread_name(named).build();
    let made = Arc::new(made.map_err(|error| format!("no threads: {error}"))?);
    pool.threads = Some(made.clone());
    Ok(made)
}

/// Sets the number of threads from the next call on; 0 is one for each processor.
#[pyfunction]
pub(crate) fn set_threads(count: usize) -> PyResult<()> {
    if count > 4096 {
        let what = format!("found {count} threads, expected at most 4096");
        return Err(PyValueError::new_err(what));
    }
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    pool.count = count;
    if pool.process == std::process::id() {
        pool.threads = None;
    }
    Ok(())
}

/// The number of threads.
#[pyfunction]
pub(crate) fn threads(py: Python<'_>) -> PyResult<usize> {
    let pool = pool().map_err(|what| internal(py, &what))?;
    Ok(pool.current_num_threads())
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

/// What the work tells its caller.
pub(crate) enum Message<M, T> {
    /// On its way.
    Event(M),
    /// At its end, or how it panicked.
    End(Result<T, String>),
}

/// Starts `work` on a thread of the package. It sends messages by the function that it is given; its
/// result is the last one.
pub(crate) fn start<M: Send + 'static, T: Send + 'static>(
    py: Python<'_>,
    interrupt: &Interrupt,
    work: impl FnOnce(&dyn Fn(M)) -> T + Send + 'static,
) -> PyResult<Receiver<Message<M, T>>> {
    let (sender, receiver) = channel();
    let own = interrupt.clone();
    let pool = pool().map_err(|what| internal(py, &what))?;
    pool.spawn(move || {
        let tell = |event| {
            // A caller that has given up needs no messages.
            let _ = sender.send(Message::Event(event));
        };
        let done = catch_unwind(AssertUnwindSafe(|| work(&tell)));
        if own.has_stopped() {
            own.reset();
        }
        let done = done.map_err(|panic| text_of(&*panic));
        let _ = sender.send(Message::End(done));
    });
    Ok(receiver)
}

/// Waits for the end of the work. `on_event` is called with the interpreter. A signal or an exception of
/// `on_event` interrupts the work, which then has half a second to end, and is raised.
pub(crate) fn wait<M: Send, T: Send>(
    py: Python<'_>,
    interrupt: &Interrupt,
    receiver: Receiver<Message<M, T>>,
    mut on_event: impl FnMut(M) -> PyResult<()>,
) -> PyResult<T> {
    // A receiver is used by one thread, but not always by the same.
    let receiver = Mutex::new(receiver);
    let next = |time: Duration| {
        let wait = || match receiver.lock() {
            Ok(receiver) => receiver.recv_timeout(time),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        };
        py.detach(wait)
    };
    let lost = || internal(py, "the thread of the work is gone");
    loop {
        let looked = match next(LOOK) {
            Ok(Message::End(Ok(result))) => {
                // A signal that came with the end is not lost.
                py.check_signals()?;
                return Ok(result);
            }
            Ok(Message::End(Err(panic))) => return Err(internal(py, &panic)),
            Ok(Message::Event(event)) => on_event(event).and_then(|()| py.check_signals()),
            Err(RecvTimeoutError::Timeout) => py.check_signals(),
            Err(RecvTimeoutError::Disconnected) => return Err(lost()),
        };
        if let Err(error) = looked {
            interrupt.stop();
            let deadline = Instant::now() + END;
            while Instant::now() < deadline {
                if let Ok(Message::End(_)) | Err(RecvTimeoutError::Disconnected) = next(LOOK) {
                    break;
                }
            }
            return Err(error);
        }
    }
}

/// Does `work` on a thread of the package and waits for it.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    interrupt: &Interrupt,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let receiver = start(py, interrupt, move |_: &dyn Fn(())| work())?;
    wait(py, interrupt, receiver, |()| Ok(()))
}

/// Panics on a thread of the package, for the test of what becomes of it.
#[pyfunction]
#[pyo3(name = "_panic")]
pub(crate) fn panic_on_purpose(py: Python<'_>) -> PyResult<()> {
    run(py, &Interrupt::new(), || panic!("on purpose"))
}
