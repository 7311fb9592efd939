//! Where the bodies are at the start, and points and axes seen from them.

use super::mass::mass_properties;
use super::quantity::{Quantity, Vector, vector};
use super::schema::Document;
use super::schema::joints::{Axis, Ends};
use super::schema::mechanics::{Location, Point};
use crate::math::rotation::{Quat, compose, from_axis_angle, matrix};
use crate::math::{Mat3, Scalar, Vec3};

/// What a body cannot lack once its file is checked.
const CHECKED: &str = "names are checked when a problem is read";

/// The name of the body that does not move.
pub(crate) const GROUND: &str = "ground";

/// Where a body is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose<S> {
    /// Origin of the body's axes in ground axes (m).
    pub origin: Vec3<S>,
    /// Centre of mass from the origin, in body axes (m).
    pub centre: Vec3<S>,
    /// Euler parameters, body axes to ground.
    pub orientation: Quat<S>,
    /// Rotation matrix, body axes to ground.
    pub rotation: Mat3<S>,
}

impl<S: Scalar> Pose<S> {
    /// The pose of ground.
    fn ground() -> Self {
        Self {
            origin: Vec3::zeros(),
            centre: Vec3::zeros(),
            orientation: [S::one(), S::zero(), S::zero(), S::zero()],
            rotation: Mat3::identity(),
        }
    }

    /// Centre of mass in ground axes (m).
    pub(crate) fn position(&self) -> Vec3<S> {
        self.origin + self.rotation * self.centre
    }
}

/// Splits `"body.point"` into the body and the point; the origin of its axes if there is no dot.
pub(crate) fn split_location(text: &str) -> (&str, Option<&str>) {
    match text.split_once('.') {
        Some((body, point)) => (body, Some(point)),
        None => (text, None),
    }
}

/// The bodies that a body is placed by.
pub(crate) fn placed_by<'a>(document: &'a Document, body: &str) -> impl Iterator<Item = &'a str> {
    let place = document.bodies.get(body).map(|body| &body.place);
    let at = place.and_then(|place| match &place.at {
        Some(Location::Named(name)) => Some(split_location(name).0),
        _ => None,
    });
    let turn = place.and_then(|place| place.relative_to.as_deref());
    at.into_iter().chain(turn).filter(|name| *name != GROUND)
}

/// The bodies in an order in which each is placed after those that it is placed by.
///
/// # Errors
/// The names along a cycle, its first one again at the end.
pub(crate) fn placement_order(document: &Document) -> Result<Vec<usize>, Vec<String>> {
    /// Visits `name` after all that it is placed by; `path` holds those that wait for it.
    fn visit(
        document: &Document,
        name: &str,
        path: &mut Vec<String>,
        order: &mut Vec<usize>,
    ) -> Result<(), Vec<String>> {
        let Some(index) = document.bodies.get_index_of(name) else {
            return Ok(());
        };
        if order.contains(&index) {
            return Ok(());
        }
        let first = path.iter().position(|waiting| waiting == name);
        path.push(name.to_owned());
        if let Some(first) = first {
            return Err(path.split_off(first));
        }
        for other in placed_by(document, name) {
            visit(document, other, path, order)?;
        }
        path.pop();
        order.push(index);
        Ok(())
    }
    let mut order = Vec::with_capacity(document.bodies.len());
    for name in document.bodies.keys() {
        visit(document, name, &mut Vec::new(), &mut order)?;
    }
    Ok(order)
}

/// All bodies of a checked document where they are at the start of the design `x`.
pub(crate) struct Assembly<'a, S> {
    document: &'a Document,
    x: &'a [S],
    /// Poses in the order of the file.
    pub poses: Vec<Pose<S>>,
}

impl<'a, S: Scalar> Assembly<'a, S> {
    /// Places the bodies in `order`.
    pub(crate) fn new(document: &'a Document, order: &[usize], x: &'a [S]) -> Self {
        let mut assembly = Self {
            document,
            x,
            poses: vec![Pose::ground(); document.bodies.len()],
        };
        for &index in order {
            assembly.poses[index] = assembly.place(index);
        }
        assembly
    }

    /// Where body `index` goes, once those that it is placed by are there.
    fn place(&self, index: usize) -> Pose<S> {
        let (name, body) = self.document.bodies.get_index(index).expect(CHECKED);
        let place = &body.place;
        let mut orientation = self
            .pose(place.relative_to.as_deref().unwrap_or(GROUND))
            .orientation;
        // Each rotation is about the fixed axes of what the turn starts from, so the list is
        // composed first and that body's orientation comes last.
        let mut turn = Pose::ground().orientation;
        for one in place.turn.iter().flat_map(|turns| turns.list()) {
            let axis = vector(&one.axis, self.x);
            turn = compose(&from_axis_angle(&axis, one.angle.get(self.x)), &turn);
        }
        orientation = compose(&orientation, &turn);
        let rotation = matrix(&orientation);
        let put = place
            .put
            .as_ref()
            .map_or(Vec3::zeros(), |point| self.in_body(name, point));
        let at = match &place.at {
            None => Vec3::zeros(),
            Some(Location::Named(text)) => self.named(text),
            Some(Location::Coordinates(point)) => vector(point, self.x),
        };
        Pose {
            origin: at - rotation * put,
            centre: mass_properties(body, self.x).centre,
            orientation,
            rotation,
        }
    }

    /// Index of a body; `None` is ground.
    pub(crate) fn index(&self, body: &str) -> Option<usize> {
        (body != GROUND).then(|| self.document.bodies.get_index_of(body).expect(CHECKED))
    }

    /// Pose of a body or ground.
    pub(crate) fn pose(&self, body: &str) -> Pose<S> {
        self.index(body)
            .map_or(Pose::ground(), |index| self.poses[index])
    }

    /// A named point of a body, from the origin of its axes.
    fn point(&self, body: &str, point: &str) -> Vec3<S> {
        let points = &self.document.bodies.get(body).expect(CHECKED).points;
        vector(points.get(point).expect(CHECKED), self.x)
    }

    /// A point of a body (or of ground) from the origin of its axes.
    pub(crate) fn in_body(&self, body: &str, point: &Point) -> Vec3<S> {
        match point {
            Point::Named(name) => self.point(body, name),
            Point::Coordinates(point) => vector(point, self.x),
        }
    }

    /// A named place in ground axes.
    pub(crate) fn named(&self, text: &str) -> Vec3<S> {
        let (body, _) = split_location(text);
        let pose = self.pose(body);
        pose.origin + pose.rotation * self.named_in_body(text)
    }

    /// A named place from the origin of the axes of the body that it belongs to.
    pub(crate) fn named_in_body(&self, text: &str) -> Vec3<S> {
        let (body, point) = split_location(text);
        point.map_or(Vec3::zeros(), |point| self.point(body, point))
    }

    /// A point of a body (or of ground) from the origin of its axes, given by its ground
    /// coordinates at the start.
    pub(crate) fn at_ground(&self, body: &str, point: &Vector) -> Vec3<S> {
        let pose = self.pose(body);
        pose.rotation.tr_mul(&(self.ground(point) - pose.origin))
    }

    /// An end of a rod or spring on its body (or on ground) from the centre of mass.
    pub(crate) fn end(&self, between: &[String; 2], at: &Ends, side: usize) -> Vec3<S> {
        let name = &between[side];
        let point = match at {
            Ends::Each(pair) => self.in_body(name, [&pair.a, &pair.b][side]),
            Ends::Ground(points) => self.at_ground(name, &points[side]),
        };
        point - self.pose(name).centre
    }

    /// A number of the file at this design.
    pub(crate) fn quantity(&self, quantity: &Quantity) -> S {
        quantity.get(self.x)
    }

    /// A vector of the file at this design.
    pub(crate) fn ground(&self, components: &Vector) -> Vec3<S> {
        vector(components, self.x)
    }

    /// A joint's axis in ground axes, of the length in the file.
    pub(crate) fn axis(&self, axis: &Axis) -> Vec3<S> {
        match axis {
            Axis::Ground(axis) => vector(axis, self.x),
            Axis::OfBody(of) => self.pose(&of.body).rotation * vector(&of.axis, self.x),
        }
    }
}
