//! An exchange of all ranks with all, along a binomial tree: 2 log₂ of their number messages in a row.

use super::post::{Post, Tag};
use crate::driver::shared::{Exchange, Lost, Message};

/// The first ranks, which share the cases of a problem.
pub(super) struct Tree {
    pub post: Post,
    pub ranks: usize,
}

impl Exchange for Tree {
    fn rank(&self) -> usize {
        self.post.rank()
    }

    fn ranks(&self) -> usize {
        self.ranks
    }

    fn all(&self, own: Message) -> Result<Vec<Message>, Lost> {
        let rank = self.post.rank();
        // A rank gathers those behind it up to the next that has more trailing zeros, in their order.
        let mut all = vec![own];
        let mut distance = 1;
        while distance < self.ranks && rank & distance == 0 {
            if rank + distance < self.ranks {
                let more: Vec<Message> = self.post.wait(rank + distance, Tag::Numbers)?;
                all.extend(more);
            }
            distance *= 2;
        }
        if rank > 0 {
            let parent = rank - distance;
            self.post.send(parent, Tag::Numbers, &all);
            all = self.post.wait(parent, Tag::Numbers)?;
        }
        while distance > 1 {
            distance /= 2;
            if rank + distance < self.ranks {
                self.post.send(rank + distance, Tag::Numbers, &all);
            }
        }
        Ok(all)
    }
}
