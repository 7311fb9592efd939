//! An exchange of all ranks with all, along a binomial tree: 2 log₂ of their number messages in a row.

use super::post::{Post, Tag};
use crate::cli::progress::progress;
use crate::driver::shared::{Exchange, Lost, Message, Shared, Together};
use crate::math::{Gather, Team};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// The first ranks, which share an optimisation.
#[derive(Clone, Copy, Debug)]
struct Tree {
    post: Post,
    ranks: usize,
}

/// Ranks that compute motions together: all give numbers to all.
#[derive(Debug)]
struct Numbers {
    tree: Tree,
    calls: AtomicU64,
    /// Whether a rank must end, as all know it after the same call.
    over: Arc<AtomicBool>,
}

/// The first `ranks`, which compute motions `together`, each with so much memory for gradients, or have their own cases.
pub(super) fn shared(post: Post, ranks: usize, together: Option<usize>) -> Arc<Shared> {
    let tree = Tree { post, ranks };
    let together = together.map(|memory| {
        let over = Arc::new(AtomicBool::new(false));
        let way = Numbers {
            tree,
            calls: AtomicU64::new(0),
            over: over.clone(),
        };
        Together {
            team: Team::of(Arc::new(way)),
            over,
            memory,
        }
    });
    Shared::new(Box::new(tree), together)
}

impl Tree {
    /// What all ranks have, in their order, from what this one has. `take` receives from a rank, `add` appends what those
    /// behind it have, and `give` sends to a rank.
    fn gather<T>(
        self,
        own: T,
        take: impl Fn(usize) -> Result<T, Lost>,
        add: impl Fn(&mut T, T),
        give: impl Fn(usize, &T),
    ) -> Result<T, Lost> {
        let rank = self.post.rank();
        // A rank gathers those behind it up to the next that has more trailing zeros, in their order.
        let mut all = own;
        let mut distance = 1;
        while distance < self.ranks && rank & distance == 0 {
            if rank + distance < self.ranks {
                add(&mut all, take(rank + distance)?);
            }
            distance *= 2;
        }
        if rank > 0 {
            let parent = rank - distance;
            give(parent, &all);
            all = take(parent)?;
        }
        while distance > 1 {
            distance /= 2;
            if rank + distance < self.ranks {
                give(rank + distance, &all);
            }
        }
        Ok(all)
    }
}

impl Exchange for Tree {
    fn rank(&self) -> usize {
        self.post.rank()
    }

    fn ranks(&self) -> usize {
        self.ranks
    }

    fn all(&self, own: Message) -> Result<Vec<Message>, Lost> {
        self.gather(
            vec![own],
            |from| self.post.wait(from, Tag::Messages),
            |all: &mut Vec<Message>, more| all.extend(more),
            |to, all| self.post.send(to, Tag::Messages, all),
        )
    }
}

/// Numbers before those that are given: which call it is, and whether a rank must end.
const HEAD: usize = 2;

impl Gather for Numbers {
    fn rank(&self) -> usize {
        self.tree.post.rank()
    }

    fn ranks(&self) -> usize {
        self.tree.ranks
    }

    fn gather(&self, own: &[f64]) -> Vec<f64> {
        let post = self.tree.post;
        let call = self.calls.fetch_add(1, Ordering::Relaxed) as f64;
        let must_end = f64::from(u8::from(progress().is_over()));
        let take = |from: usize| {
            let told = post.wait_for_numbers(from);
            assert!(
                told[0] == call,
                "rank {from} is at another place than rank {}: are their processors or programs different?",
                post.rank()
            );
            Ok(told)
        };
        let add = |all: &mut Vec<f64>, more: Vec<f64>| {
            all[1] = all[1].max(more[1]);
            all.extend(&more[HEAD..]);
        };
        let give = |to: usize, all: &Vec<f64>| post.send_numbers(to, all);
        let own = [&[call, must_end], own].concat();
        let Ok(mut all) = self.tree.gather(own, take, add, give) else {
            unreachable!("numbers are waited for until they come");
        };
        if all[1] > 0.0 {
            self.over.store(true, Ordering::Relaxed);
        }
        all.drain(..HEAD);
        all
    }
}
