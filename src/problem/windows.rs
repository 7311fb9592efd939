//! Reductions over windows of time, from a file.

use super::quantities::FunctionBuilder;
use crate::functions::{Edge, Function, Operation, Quantity, Reach, Reduction, Window};
use crate::math::Scalar;
use crate::schema::functions::Instant as Written;
use crate::schema::windows::{During, Edge as WrittenEdge, Over, ValueAt};

impl<S: Scalar> FunctionBuilder<'_, S> {
    /// A reduction of a quantity over a window, or over the whole run.
    pub(super) fn reduced(
        &self,
        of: &Written,
        during: Option<&During>,
        reduction: Reduction,
    ) -> Function<S> {
        Function::Reduced {
            of: self.quantity(of),
            during: during.and_then(|during| self.window(during)),
            reduction,
        }
    }

    pub(super) fn over(&self, over: &Over, reduction: Reduction) -> Function<S> {
        self.reduced(over.of(), over.during(), reduction)
    }

    /// The mean of a quantity under an operation.
    pub(super) fn mean_of(
        &self,
        operation: Operation,
        of: &Written,
        during: Option<&During>,
    ) -> Function<S> {
        Function::Reduced {
            of: Quantity::Combined {
                operation,
                of: vec![self.quantity(of)],
            },
            during: during.and_then(|during| self.window(during)),
            reduction: Reduction::Mean,
        }
    }

    /// The value at the end of a window that ends at the time.
    pub(super) fn value_at(&self, value: &ValueAt) -> Function<S> {
        let during = || Window {
            from: Edge::Start,
            to: self.edge(&value.at),
        };
        Function::Reduced {
            of: self.quantity(&value.of),
            // It ends a phase of the motion.
            during: value.at.event().is_none().then(during),
            reduction: Reduction::Final,
        }
    }

    /// A window; `None` if events are its ends: then it has whole phases of the motion.
    fn window(&self, during: &During) -> Option<Window<S>> {
        Some(match during {
            During::Times([from, to]) => Window {
                from: Edge::At(from.get(self.x)),
                to: Edge::At(to.get(self.x)),
            },
            During::Between(own) => {
                let ends = [&own.from, &own.to].into_iter().flatten();
                if ends.clone().all(|end| end.event().is_some()) {
                    return None;
                }
                Window {
                    from: (own.from.as_ref()).map_or(Edge::Start, |edge| self.edge(edge)),
                    to: (own.to.as_ref()).map_or(Edge::End, |edge| self.edge(edge)),
                }
            }
        })
    }

    fn edge(&self, edge: &WrittenEdge) -> Edge<S> {
        match edge {
            WrittenEdge::Event(_) => Edge::Start,
            WrittenEdge::Time(time) => Edge::At(time.get(self.x)),
            WrittenEdge::When(reach) => {
                let (value, rises) = (reach.values().into_iter().next())
                    .expect("a window has one value to reach, which is checked");
                Edge::When(Reach {
                    of: self.quantity(&reach.when),
                    value: value.get(self.x),
                    rises,
                })
            }
        }
    }
}
