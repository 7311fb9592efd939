//! Rank 0: the queue of starts, and who runs which.

use super::crew::Crew;
use super::letters::{Description, Event, Letter, Reply, SharedProblem, Task};
use super::post::{Pause, Post, Tag};
use super::tree::shared;
use crate::cli::interrupt;
use crate::driver::memory;
use crate::driver::multi_start::{Run, begin};
use crate::driver::packed::PackedRun;
use crate::driver::ranks::{OpenLog, Ranks, StartLog};
use crate::driver::shared::Shared;
use crate::optimiser::SavedState;
use crate::problem::{Division, Problem};
use crate::report::evaluations::EvaluationRecord;
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long the starts may take to end after they were told to: after an interrupt, and else.
const AFTER_INTERRUPT: Duration = Duration::from_millis(300);
const AFTER_FAULT: Duration = Duration::from_secs(3);
/// How long ranks may take to hear that there is no more work.
const DISMISSAL: Duration = Duration::from_secs(3);
/// Longest sleep of rank 0 between two looks.
const LOOK: Duration = Duration::from_micros(500);

/// A start: the number of its problem, and its place in the order of that problem's starts. Lower ones begin first. Place
/// 0 is that of a start that was not announced, as from the optimum before.
type Place = (usize, usize);

/// Rank 0, as the command uses it.
pub(super) struct Hub {
    post: Post,
    state: RefCell<State>,
}

/// A rank whose last letter waits for an answer.
#[derive(Clone, Copy)]
struct Asking {
    free: usize,
    running: usize,
    announced: u64,
}

struct State {
    file: PathBuf,
    crew: Crew,
    /// Number of the announcement, and its problems with the number of their starts.
    announced: u64,
    problems: Vec<(Arc<Problem>, usize)>,
    descriptions: Vec<Description>,
    waiting: BTreeMap<Place, Vec<f64>>,
    running: HashMap<u64, Place>,
    done: HashMap<Place, Option<Box<PackedRun>>>,
    asking: BTreeMap<usize, Asking>,
    next: u64,
    stop: bool,
}

/// What `multi_start` needs to hand out starts of its problem.
struct Course<'a, 'j> {
    of: usize,
    /// 1 if there is a start that was not announced.
    first: usize,
    begun: Instant,
    open: Option<&'a OpenLog<'j>>,
}

/// The logs of the starts that run.
type Logs<'j> = HashMap<u64, StartLog<'j>>;

impl Hub {
    pub fn new(post: Post) -> Self {
        let state = State {
            file: PathBuf::new(),
            crew: Crew::new(),
            announced: 0,
            problems: Vec::new(),
            descriptions: Vec::new(),
            waiting: BTreeMap::new(),
            running: HashMap::new(),
            done: HashMap::new(),
            asking: BTreeMap::new(),
            next: 0,
            stop: false,
        };
        Self {
            post,
            state: RefCell::new(state),
        }
    }

    /// Tells all ranks that there is no more work. Whether all heard it.
    pub fn dismiss(&self) -> bool {
        let mut state = self.state.borrow_mut();
        let mut left: Vec<usize> = (1..self.post.ranks()).collect();
        let (since, mut pause) = (Instant::now(), Pause::up_to(LOOK));
        while !left.is_empty() && since.elapsed() < DISMISSAL {
            left.retain(|rank| {
                let letter = || self.post.look::<Letter>(Some(*rank), Tag::Letter);
                let asked = state.asking.remove(rank).map(|own| own.running);
                let running = asked.or_else(|| Some(letter()?.1.running));
                let reply = match running {
                    None => return true,
                    Some(0) => Reply::End,
                    // Starts that were begun ahead, and that nobody waits for.
                    Some(_) => Reply::Tasks(Vec::new(), true),
                };
                self.post.send(*rank, Tag::Reply, &reply);
                running != Some(0)
            });
            pause.sleep();
        }
        left.is_empty()
    }
}

impl State {
    /// The next start in the queue, as a task. Its log is opened.
    fn next<'j>(&mut self, course: &Course<'_, 'j>, logs: &mut Logs<'j>) -> Option<Task> {
        while !self.stop {
            let (place, design) = self.waiting.pop_first()?;
            let (of, order) = place;
            let is_ahead = of != course.of;
            let (start, since) = match is_ahead {
                true => (order, Instant::now()),
                false => (order + course.first - 1, course.begun),
            };
            let begun = begin(&self.problems[of].0, (start, &design), since);
            let log = match (&begun, course.open.filter(|_| !is_ahead)) {
                (Some(begun), Some(open)) => open(start, begun).map(Some),
                (Some(_), None) => Some(None),
                (None, _) => None,
            };
            let (Some(begun), Some(mut log)) = (begun, log) else {
                self.done.insert(place, None);
                continue;
            };
            self.next += 1;
            let id = self.next;
            let earlier = log.as_mut().map(|log| std::mem::take(&mut log.earlier));
            logs.extend(log.map(|log| (id, log)));
            self.running.insert(id, place);
            return Some(Task {
                id,
                of,
                start,
                design,
                seconds: begun.optimiser.seconds,
                earlier: earlier.unwrap_or_default(),
            });
        }
        None
    }

    /// Notes what happened in starts.
    fn take(&mut self, events: Vec<Event>, logs: &mut Logs<'_>) {
        for event in events {
            match event {
                Event::Record(id, record) => {
                    if let Some(log) = logs.get_mut(&id) {
                        (log.record)(*record);
                    }
                }
                Event::Done(id, run) => {
                    logs.remove(&id);
                    if let Some(place) = self.running.remove(&id) {
                        self.done.insert(place, run);
                    }
                }
            }
        }
    }

    fn take_letter(&mut self, (rank, letter): (usize, Letter), logs: &mut Logs<'_>) {
        if letter.interrupted {
            interrupt::ask();
        }
        self.take(letter.events, logs);
        let asking = Asking {
            free: letter.free,
            running: letter.running,
            announced: letter.announced,
        };
        self.asking.insert(rank, asking);
    }

    /// Hands out starts, one at a time to each rank, and answers those that cannot wait.
    fn hand_out<'j>(&mut self, post: &Post, course: &Course<'_, 'j>, logs: &mut Logs<'j>) {
        if self.crew.free() > 0
            && let Some(task) = self.next(course, logs)
        {
            let problem = Arc::clone(&self.problems[task.of].0);
            self.crew.begin(problem, task);
        }
        for (rank, asking) in self.asking.clone() {
            let task = match asking.free > 0 && asking.announced == self.announced {
                true => self.next(course, logs),
                false => None,
            };
            let reply = match task {
                _ if asking.announced != self.announced => {
                    Reply::Problems(self.announced, self.descriptions.clone())
                }
                Some(task) => Reply::Tasks(vec![task], false),
                None if asking.running > 0 => Reply::Tasks(Vec::new(), self.stop),
                // It waits until there is something to do.
                None => continue,
            };
            self.asking.remove(&rank);
            post.send(rank, Tag::Reply, &reply);
        }
    }
}

impl Ranks for Hub {
    fn read_from(&self, file: &Path) {
        self.state.borrow_mut().file = file.to_path_buf();
    }

    fn announce(&self, problems: Vec<(Problem, Vec<Vec<f64>>)>) {
        let mut state = self.state.borrow_mut();
        state.announced += 1;
        state.descriptions.clear();
        state.problems.clear();
        for (of, (problem, starts)) in problems.into_iter().enumerate() {
            let description = Description::of(&problem, &state.file);
            state.descriptions.push(description);
            state.problems.push((Arc::new(problem), starts.len()));
            let placed = starts.into_iter().enumerate();
            let placed = placed.map(|(k, design)| ((of, k + 1), design));
            state.waiting.extend(placed);
        }
    }

    fn multi_start(
        &self,
        of: usize,
        first: Option<Vec<f64>>,
        stopped: &dyn Fn() -> bool,
        open: Option<&OpenLog<'_>>,
    ) -> Vec<Run> {
        let mut state = self.state.borrow_mut();
        let state = &mut *state;
        let course = Course {
            of,
            first: usize::from(first.is_some()),
            begun: Instant::now(),
            open,
        };
        let mut logs = Logs::new();
        let (problem, count) = state.problems[of].clone();
        state.waiting.extend(first.map(|design| ((of, 0), design)));
        let places = (1 - course.first..=count).map(|order| (of, order));
        let places: Vec<Place> = places.collect();
        let (mut pause, mut ended) = (Pause::up_to(LOOK), None::<Instant>);
        loop {
            let events = state.crew.events();
            let is_news = !events.is_empty();
            state.take(events, &mut logs);
            while let Some(letter) = self.post.look(None, Tag::Letter) {
                state.take_letter(letter, &mut logs);
            }
            if stopped() && !state.stop {
                state.stop = true;
                state.crew.stop();
                ended = Some(Instant::now());
            }
            state.hand_out(&self.post, &course, &mut logs);
            let is_done = |place: &Place| match ended {
                None => state.done.contains_key(place),
                Some(_) => !state.running.values().any(|own| own == place),
            };
            let patience = match interrupt::asked() {
                true => AFTER_INTERRUPT,
                false => AFTER_FAULT,
            };
            let is_late = ended.is_some_and(|since| since.elapsed() > patience);
            if places.iter().all(is_done) || is_late {
                break;
            }
            match is_news {
                true => pause = Pause::up_to(LOOK),
                false => pause.sleep(),
            }
        }
        let found = places.iter().filter_map(|place| {
            let run = state.done.remove(place)??;
            Some((place.1 + course.first - 1, run))
        });
        let found: Vec<_> = found.collect();
        let unpack = |(start, run): (usize, Box<PackedRun>)| run.unpack(&problem, start);
        found.into_iter().map(unpack).collect()
    }

    fn share(
        &self,
        problem: &Problem,
        bodies: bool,
        state: Option<&SavedState>,
        earlier: &[EvaluationRecord],
    ) -> Option<Arc<Shared>> {
        let mut own = self.state.borrow_mut();
        let cases = problem
            .cases
            .as_ref()
            .map_or(0, |cases| match cases.division {
                Division::Cases => cases.list.len(),
                // The phases of a motion follow each other.
                Division::Events => 0,
            });
        let together = (bodies && cases < 2 && problem.can_be_shared()).then(|| {
            // All ranks may be on one machine.
            let given = problem.simulation.memory;
            given.unwrap_or_else(|| memory::usual() / self.post.ranks())
        });
        let ranks = match together {
            Some(_) => self.post.ranks(),
            None => self.post.ranks().min(cases),
        };
        if ranks < 2 {
            return None;
        }
        for rank in 1..ranks {
            if own.asking.remove(&rank).is_none() {
                self.post.wait::<Letter>(rank, Tag::Letter).ok()?;
            }
            let of = SharedProblem {
                description: Description::of(problem, &own.file),
                start: problem.start(),
                ranks,
                together,
                state: state.cloned(),
                earlier: earlier.to_vec(),
            };
            let reply = Reply::Shared(Box::new(of));
            self.post.send(rank, Tag::Reply, &reply);
        }
        Some(shared(self.post, ranks, together))
    }
}
