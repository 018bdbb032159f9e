# mypy: allow-untyped-decorators
"""Decision trees as plain arrays: boosted trees, and quantile forests.

scikit-learn grows them (`noise.training.trees`); kept are a few arrays. Such a model runs no code
when it is opened, works under any version of scikit-learn (or none) and gives the same bytes
everywhere, which a pickle does not. Boosted trees tell classes apart: many weak features tell creak
from squawk, and a random forest of the same samples errs a sixth more often.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, NamedTuple, Self

import numpy as np
from numba import njit
from numpy.typing import NDArray

from models.compilation import COMPILED, PART
from models.show import short_repr

LEAF = -1
"""Stands for the feature of a node that asks for none."""


@dataclass(frozen=True, eq=False)
class Trees:
    """Decision trees, their nodes one after the other.

    Parameters
    ----------
    roots : ndarray of int32, shape (n_trees,)
        First node of each tree.
    feature : ndarray of int16, shape (n_nodes,)
        Feature that a node looks at; `LEAF` in a leaf.
    threshold : ndarray of float, shape (n_nodes,)
        Up to it the way goes left [unit of the feature].
    children : ndarray of int32, shape (n_nodes, 2)
        Left and right child; none of a leaf counts.
    missing_left : ndarray of bool, shape (n_nodes,)
        Whether NaN goes left.
    """

    roots: NDArray[np.int32]
    feature: NDArray[np.int16]
    threshold: NDArray[np.floating[Any]]
    children: NDArray[np.int32]
    missing_left: NDArray[np.bool_]

    def check(self, n_features: int) -> None:
        """Refuse trees that cannot be evaluated.

        Parameters
        ----------
        n_features : int
            Of the samples.

        Raises
        ------
        ValueError
            Some way through them does not end in a leaf, or asks for a feature that there is not.
        """
        n = len(self.feature)
        lengths = {len(a) for a in (self.threshold, self.children, self.missing_left)}
        if lengths != {n} or self.children.shape[1:] != (2,) or not len(self.roots):
            raise ValueError("its arrays do not fit together")
        if any(a.dtype.kind != "i" for a in (self.roots, self.feature, self.children)):
            raise ValueError("its nodes are numbered by what are no whole numbers")
        inner = np.flatnonzero(self.feature != LEAF)
        descends = (self.children[inner] > inner[:, None]) & (self.children[inner] < n)
        starts = (self.roots >= 0) & (self.roots < n)
        if not (descends.all() and starts.all()):
            raise ValueError("its trees do not end")
        if self.feature.min() < LEAF or self.feature.max() >= n_features:
            raise ValueError("its trees ask for features that it does not name")

    def leaves(self, x: NDArray[np.floating[Any]]) -> NDArray[np.int32]:
        """Return the leaf that each sample comes to in each tree.

        Parameters
        ----------
        x : ndarray, shape (n, n_features)
            [unit of each feature]; NaN where it is missing.

        Returns
        -------
        ndarray of int32, shape (n, n_trees)
            Nodes.
        """
        found = np.empty((len(x), len(self.roots)), dtype=np.int32)
        _lead_to_leaves(self._nodes(), np.ascontiguousarray(x), found)
        return found

    def _nodes(self) -> _Nodes:
        return _Nodes(*(getattr(self, name) for name in _Nodes._fields))


class _Nodes(NamedTuple):
    """The arrays of `Trees`, as compiled functions take them."""

    roots: NDArray[np.int32]
    feature: NDArray[np.int16]
    threshold: NDArray[np.floating[Any]]
    children: NDArray[np.int32]
    missing_left: NDArray[np.bool_]


@njit(cache=True, **PART)
def _leaf(node: int, nodes: _Nodes, sample: NDArray[np.floating[Any]]) -> int:
    """Return the leaf that a sample comes to from a tree's root."""
    while nodes.feature[node] != LEAF:
        value = sample[nodes.feature[node]]
        right = value > nodes.threshold[node] or (value != value and not nodes.missing_left[node])
        node = nodes.children[node, int(right)]
    return node


@njit(cache=True, **COMPILED)
def _lead_to_leaves(nodes: _Nodes, x: NDArray[np.floating[Any]], found: NDArray[np.int32]) -> None:
    # Tree by tree, so that a tree stays in the cache.
    for tree in range(nodes.roots.size):
        for row in range(x.shape[0]):
            found[row, tree] = _leaf(nodes.roots[tree], nodes, x[row])


@njit(cache=True, **COMPILED)
def _add_leaves(
    nodes: _Nodes,
    x: NDArray[np.floating[Any]],
    classes: NDArray[np.int16],
    added: NDArray[np.float64],
    scores: NDArray[np.float64],
) -> None:
    # Tree by tree: the sums of a row do not depend on how many rows there are.
    for tree in range(nodes.roots.size):
        for row in range(x.shape[0]):
            scores[row, classes[tree]] += added[_leaf(nodes.roots[tree], nodes, x[row])]


@short_repr
@dataclass(frozen=True, eq=False)
class BoostedTrees(Trees):
    """Trees whose leaves add to the scores of classes.

    Parameters
    ----------
    roots, feature, threshold, children, missing_left : ndarray
        As of `Trees`.
    classes : ndarray of int16, shape (n_trees,)
        Class whose score a tree adds to.
    value : ndarray of float64, shape (n_nodes,)
        What a leaf adds [-].
    base : ndarray of float64, shape (n_classes,)
        Scores before any tree [-].
    """

    classes: NDArray[np.int16]
    value: NDArray[np.float64]
    base: NDArray[np.float64]

    def check(self, n_features: int) -> None:
        """Refuse trees that cannot be evaluated, as `Trees.check` does.

        Raises
        ------
        ValueError
            As of `Trees.check`, or the leaves hold what cannot be used.
        """
        super().check(n_features)
        if self.value.shape != self.feature.shape or self.classes.shape != self.roots.shape:
            raise ValueError("its arrays do not fit together")
        if not (np.isfinite(self.value).all() and np.isfinite(self.base).all()):
            raise ValueError("its leaves hold values that are no numbers")
        known = (self.classes >= 0) & (self.classes < self.base.size)
        if self.classes.dtype.kind != "i" or not known.all():
            raise ValueError("its trees speak for classes that there are not")

    def scores(self, x: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Sum of what the trees of each class say.

        Parameters
        ----------
        x : ndarray, shape (n, n_features)
            [unit of each feature]; NaN where it is missing.

        Returns
        -------
        ndarray, shape (n, n_classes)
            [-]
        """
        scores = np.tile(self.base.astype(np.float64), (len(x), 1))
        _add_leaves(self._nodes(), np.ascontiguousarray(x), self.classes, self.value, scores)
        return scores

    def probabilities(self, x: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Probabilities of the classes, not calibrated; arguments as of `scores`."""
        scores = self.scores(x)
        p = np.exp(scores - scores.max(axis=1, keepdims=True))
        return np.asarray(p / p.sum(axis=1, keepdims=True))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the arrays that a model file keeps, by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> Self:
        """Return the trees that a model file keeps among its arrays."""
        return cls(**{field.name: arrays[field.name] for field in fields(cls)})


@short_repr
@dataclass(frozen=True, eq=False)
class QuantileForest(Trees):
    """Regression trees whose leaves keep what is asked for as a distribution.

    A forest's leaf holds the training values that came to it; those of all trees together are the
    distribution of what is asked for, given the features (N. Meinshausen, *Quantile Regression
    Forests*, Journal of Machine Learning Research 7, 2006, 983-999). Here a leaf keeps a few order
    statistics of its values in place of all of them, so that the file stays small.

    Parameters
    ----------
    roots, feature, threshold, children, missing_left : ndarray
        As of `Trees`, the left child being the next node; thresholds of single precision.
    values : ndarray of float16, shape (n_leaves, n_kept)
        What the leaves keep [unit of what is asked for], in the order of the leaves.
    """

    values: NDArray[np.float16]

    def check(self, n_features: int) -> None:
        """Refuse trees that cannot be evaluated, as `Trees.check` does.

        Raises
        ------
        ValueError
            As of `Trees.check`, or the leaves hold what cannot be used.
        """
        super().check(n_features)
        if self.values.ndim != 2 or len(self.values) != np.count_nonzero(self.feature == LEAF):
            raise ValueError("its leaves and their values do not fit together")
        if not np.isfinite(self.values).all():
            raise ValueError("its leaves hold values that are no numbers")

    def pooled(self, x: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
        """Values of the leaves that samples come to, in rising order.

        Parameters
        ----------
        x : ndarray, shape (n, n_features)
            [unit of each feature]; NaN where it is missing.

        Returns
        -------
        ndarray of float32, shape (n, n_trees * n_kept)
            [unit of what is asked for]
        """
        # As scikit-learn does, features are compared in single precision.
        found = self.leaves(np.asarray(x, dtype=np.float32))
        rows = np.cumsum(self.feature == LEAF) - 1
        values = self.values[rows[found]].astype(np.float32)
        return np.sort(values.reshape(len(found), -1), axis=1)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the arrays that a model file keeps, by name.

        One number a node stands for its children: the right child, or the row of a leaf's values.
        """
        leaf = self.feature == LEAF
        following = np.where(leaf, np.cumsum(leaf) - 1, self.children[:, 1]).astype(np.int32)
        kept = ("roots", "feature", "threshold", "missing_left", "values")
        return {**{name: getattr(self, name) for name in kept}, "following": following}

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> Self:
        """Return the forest that a model file keeps among its arrays.

        Raises
        ------
        ValueError
            The values of the leaves are not in the leaves' order.
        """
        kept = {name: array for name, array in arrays.items() if name != "following"}
        following, leaf = arrays["following"], arrays["feature"] == LEAF
        rows = np.cumsum(leaf) - 1
        if following.shape != rows.shape or not np.array_equal(following[leaf], rows[leaf]):
            raise ValueError("its leaves and their values do not fit together")
        left = np.arange(1, len(following) + 1, dtype=np.int32)
        return cls(children=np.stack([left, following], axis=1), **kept)
