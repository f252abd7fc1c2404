//! Columns of numbers that begin where a line of the cache does.

use std::ops::{Deref, DerefMut};

use aligned_vec::{AVec, ConstAlign};

/// Bytes of a line of the cache, and of the widest register.
pub(crate) const LINE: usize = 64;

/// A vector whose first element lies at a multiple of 64 bytes, so that neither a record nor a register of two lies on two lines of the
/// cache: where other vectors begin is a matter of who asked for memory before.
#[derive(Debug, PartialEq)]
pub(crate) struct Column<T>(AVec<T, ConstAlign<LINE>>);

impl<T> Default for Column<T> {
    fn default() -> Self {
        Self(AVec::new(LINE))
    }
}

impl<T: Clone> Clone for Column<T> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }

    /// Keeps the memory that is there.
    fn clone_from(&mut self, other: &Self) {
        self.0.clear();
        self.0.extend_from_slice(other);
    }
}

impl<T> Deref for Column<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        &self.0
    }
}

impl<T> DerefMut for Column<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.0
    }
}

impl<T> Extend<T> for Column<T> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, values: I) {
        let values = values.into_iter();
        self.0.reserve(values.size_hint().0);
        values.for_each(|value| self.0.push(value));
    }
}

impl<T> FromIterator<T> for Column<T> {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        let mut column = Self::default();
        column.extend(values);
        column
    }
}

impl<'a, T> IntoIterator for &'a Column<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}

impl<'a, T> IntoIterator for &'a mut Column<T> {
    type Item = &'a mut T;
    type IntoIter = std::slice::IterMut<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter_mut()
    }
}

#[cfg(feature = "serde")]
impl<T: serde::Serialize> serde::Serialize for Column<T> {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(self)
    }
}

#[cfg(feature = "serde")]
impl<'de, T: serde::Deserialize<'de>> serde::Deserialize<'de> for Column<T> {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        Vec::deserialize(from).map(Self::from_iter)
    }
}

impl<T> Column<T> {
    pub(crate) fn push(&mut self, value: T) {
        self.0.push(value);
    }

    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }

    /// Have room for so many in all, and for no more.
    pub(crate) fn reserve(&mut self, length: usize) {
        self.0.reserve_exact(length.saturating_sub(self.0.len()));
    }

    /// Whether so many fit in without more memory.
    pub(crate) fn has_room(&self, length: usize) -> bool {
        length <= self.0.capacity()
    }

    /// Cut or fill up with a value.
    pub(crate) fn resize(&mut self, length: usize, value: T)
    where
        T: Clone,
    {
        if length < self.0.len() {
            self.0.truncate(length);
            return;
        }
        if self.0.is_empty() {
            self.make_empty(length);
        }
        self.0.resize(length, value);
    }

    /// Hold nothing, with room for so many: the old memory goes before more is asked for.
    pub(crate) fn make_empty(&mut self, room: usize) {
        self.clear();
        if !self.has_room(room) {
            let capacity = room.max(2 * self.0.capacity());
            self.0 = AVec::new(LINE);
            self.0 = AVec::with_capacity(LINE, capacity);
        }
    }

    /// Be of this length: what is there is of no account, and goes if more memory is needed.
    pub(crate) fn make_room(&mut self, length: usize, value: T)
    where
        T: Clone,
    {
        if !self.has_room(length) {
            self.clear();
        }
        self.resize(length, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::Record;

    fn begins_a_line<T>(column: &Column<T>) -> bool {
        column.as_ptr().addr().is_multiple_of(LINE)
    }

    #[test]
    fn columns_begin_a_line_of_the_cache_however_they_grow() {
        let (mut bytes, mut records) = (Column::default(), Column::default());
        for k in 0..5000 {
            bytes.push(k as u8);
            records.push(Record::new(glam::DVec3::X, f64::from(k)));
            assert!(begins_a_line(&bytes) && begins_a_line(&records), "{k}");
        }
        let (copy, capacity) = (records.clone(), records.0.capacity());
        records.resize(3, Record::ZERO);
        records.resize(7, Record::ZERO);
        assert_eq!(records.iter().map(|r| r.w).collect::<Vec<_>>(), [0., 1., 2., 0., 0., 0., 0.]);
        records.clone_from(&copy);
        assert!(records.iter().zip(&copy).all(|(a, b)| a.w == b.w) && records.len() == 5000);
        assert_eq!(records.0.capacity(), capacity, "no memory is asked for");
        records.clear();
        records.resize(20_000, Record::ZERO);
        assert!(begins_a_line(&records) && records.iter().all(|r| r.w == 0.0));
        records.make_room(7, Record::ZERO);
        assert_eq!(records.len(), 7);
        records.make_room(50_000, Record::ZERO);
        assert!(begins_a_line(&records) && records.len() == 50_000);
        assert!(begins_a_line(&(0..9u32).collect::<Column<_>>()));
    }
}
