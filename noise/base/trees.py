# mypy: allow-untyped-decorators
"""Evaluation of boosted trees and quantile regression forests stored as plain arrays.

scikit-learn grows the trees (`noise.training.trees`). Unlike a pickle, the arrays run no code when
they are loaded and do not depend on the version of scikit-learn. Boosted trees classify the noises;
a random forest trained on the same samples makes a sixth more errors.
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
"""Feature number of a leaf."""


@dataclass(frozen=True, eq=False)
class Trees:
    """Decision trees with concatenated nodes.

    Parameters
    ----------
    roots : ndarray of int32, shape (n_trees,)
        Root node of each tree.
    feature : ndarray of int16, shape (n_nodes,)
        Feature that a node splits; `LEAF` for a leaf.
    threshold : ndarray of float, shape (n_nodes,)
        Largest value that goes to the left child [unit of the feature].
    children : ndarray of int32, shape (n_nodes, 2)
        Left and right child; ignored for a leaf.
    missing_left : ndarray of bool, shape (n_nodes,)
        Whether NaN goes to the left child.
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
            Number of features of a sample.

        Raises
        ------
        ValueError
            A path does not end in a leaf, or a node splits a feature that does not exist.
        """
        n = len(self.feature)
        lengths = {len(a) for a in (self.threshold, self.children, self.missing_left)}
        if lengths != {n} or self.children.shape[1:] != (2,) or not len(self.roots):
            raise ValueError("its arrays do not fit together")
        if any(a.dtype.kind != "i" for a in (self.roots, self.feature, self.children)):
            raise ValueError("its node numbers are not whole numbers")
        inner = np.flatnonzero(self.feature != LEAF)
        descends = (self.children[inner] > inner[:, None]) & (self.children[inner] < n)
        starts = (self.roots >= 0) & (self.roots < n)
        if not (descends.all() and starts.all()):
            raise ValueError("its trees do not end")
        if self.feature.min() < LEAF or self.feature.max() >= n_features:
            raise ValueError("its trees use features that it does not name")

    def leaves(self, x: NDArray[np.floating[Any]]) -> NDArray[np.int32]:
        """Return the leaf of each sample in each tree.

        Parameters
        ----------
        x : ndarray, shape (n, n_features)
            [unit of each feature]; NaN where it is missing.

        Returns
        -------
        ndarray of int32, shape (n, n_trees)
            Node numbers.
        """
        leaves = np.empty((len(x), len(self.roots)), dtype=np.int32)
        _find_leaves(self._nodes(), np.ascontiguousarray(x), leaves)
        return leaves

    def _nodes(self) -> _Nodes:
        """Return the arrays for compiled functions."""
        return _Nodes(*(getattr(self, name) for name in _Nodes._fields))


class _Nodes(NamedTuple):
    """Arrays of `Trees` as a tuple, which compiled functions accept."""

    roots: NDArray[np.int32]
    feature: NDArray[np.int16]
    threshold: NDArray[np.floating[Any]]
    children: NDArray[np.int32]
    missing_left: NDArray[np.bool_]


@njit(cache=True, **PART)
def _leaf(node: int, nodes: _Nodes, sample: NDArray[np.floating[Any]]) -> int:
    """Return the leaf of a sample below a node."""
    while nodes.feature[node] != LEAF:
        value = sample[nodes.feature[node]]
        right = value > nodes.threshold[node] or (value != value and not nodes.missing_left[node])
        node = nodes.children[node, int(right)]
    return node


@njit(cache=True, **COMPILED)
def _find_leaves(nodes: _Nodes, x: NDArray[np.floating[Any]], leaves: NDArray[np.int32]) -> None:
    """Write the leaf of each sample in each tree into `leaves`."""
    # Tree by tree, so that a tree stays in the cache.
    for tree in range(nodes.roots.size):
        for row in range(x.shape[0]):
            leaves[row, tree] = _leaf(nodes.roots[tree], nodes, x[row])


@njit(cache=True, **COMPILED)
def _add_leaves(
    nodes: _Nodes,
    x: NDArray[np.floating[Any]],
    classes: NDArray[np.int16],
    added: NDArray[np.float64],
    scores: NDArray[np.float64],
) -> None:
    """Add the leaf values of each sample to the scores of their classes."""
    # Tree by tree: the scores of a row do not depend on the number of rows.
    for tree in range(nodes.roots.size):
        for row in range(x.shape[0]):
            scores[row, classes[tree]] += added[_leaf(nodes.roots[tree], nodes, x[row])]


@short_repr
@dataclass(frozen=True, eq=False)
class BoostedTrees(Trees):
    """Gradient-boosted trees for classification.

    Parameters
    ----------
    roots, feature, threshold, children, missing_left : ndarray
        As for `Trees`.
    classes : ndarray of int16, shape (n_trees,)
        Class of each tree.
    value : ndarray of float64, shape (n_nodes,)
        Contribution of a leaf to the score of the class [-].
    base : ndarray of float64, shape (n_classes,)
        Initial scores of the classes [-].
    """

    classes: NDArray[np.int16]
    value: NDArray[np.float64]
    base: NDArray[np.float64]

    def check(self, n_features: int) -> None:
        """Refuse trees that cannot be evaluated.

        Raises
        ------
        ValueError
            As for `Trees.check`, or leaf values or classes are invalid.
        """
        super().check(n_features)
        if self.value.shape != self.feature.shape or self.classes.shape != self.roots.shape:
            raise ValueError("its arrays do not fit together")
        if not (np.isfinite(self.value).all() and np.isfinite(self.base).all()):
            raise ValueError("its leaves hold values that are no numbers")
        known = (self.classes >= 0) & (self.classes < self.base.size)
        if self.classes.dtype.kind != "i" or not known.all():
            raise ValueError("its trees belong to classes that do not exist")

    def scores(self, x: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return the scores of the classes before the softmax.

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
        """Return uncalibrated probabilities of the classes, the softmax of `scores`, same shape."""
        scores = self.scores(x)
        p = np.exp(scores - scores.max(axis=1, keepdims=True))
        return np.asarray(p / p.sum(axis=1, keepdims=True))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the arrays for a model file by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> Self:
        """Return the trees from the arrays of a model file."""
        return cls(**{field.name: arrays[field.name] for field in fields(cls)})


@short_repr
@dataclass(frozen=True, eq=False)
class QuantileForest(Trees):
    """Quantile regression forest.

    A leaf holds the training targets that reached it; those of all trees together approximate the
    conditional distribution of the target (N. Meinshausen, *Quantile Regression Forests*, Journal
    of Machine Learning Research 7, 2006, 983-999). To keep the file small, a leaf stores a few
    order statistics in place of all values.

    Parameters
    ----------
    roots, feature, threshold, children, missing_left : ndarray
        As for `Trees`; the left child is the next node, and thresholds have single precision.
    values : ndarray of float16, shape (n_leaves, n_statistics)
        Order statistics of each leaf [unit of the target], in the order of the leaves.
    """

    values: NDArray[np.float16]

    def check(self, n_features: int) -> None:
        """Refuse trees that cannot be evaluated.

        Raises
        ------
        ValueError
            As for `Trees.check`, or leaf values are invalid.
        """
        super().check(n_features)
        if self.values.ndim != 2 or len(self.values) != np.count_nonzero(self.feature == LEAF):
            raise ValueError("its leaves and their values do not fit together")
        if not np.isfinite(self.values).all():
            raise ValueError("its leaves hold values that are no numbers")

    def pooled(self, x: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
        """Return the sorted values of all leaves that each sample reaches.

        Parameters
        ----------
        x : ndarray, shape (n, n_features)
            [unit of each feature]; NaN where it is missing.

        Returns
        -------
        ndarray of float32, shape (n, n_trees * n_statistics)
            [unit of the target]
        """
        # scikit-learn compares features in single precision.
        leaves = self.leaves(np.asarray(x, dtype=np.float32))
        rows = np.cumsum(self.feature == LEAF) - 1
        values = self.values[rows[leaves]].astype(np.float32)
        return np.sort(values.reshape(len(leaves), -1), axis=1)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the arrays for a model file by name.

        ``following`` replaces the children: the right child, or the row of values of a leaf.
        """
        leaf = self.feature == LEAF
        following = np.where(leaf, np.cumsum(leaf) - 1, self.children[:, 1]).astype(np.int32)
        names = ("roots", "feature", "threshold", "missing_left", "values")
        return {**{name: getattr(self, name) for name in names}, "following": following}

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> Self:
        """Return the forest from the arrays of a model file.

        Raises
        ------
        ValueError
            The values are not in the order of the leaves.
        """
        others = {name: array for name, array in arrays.items() if name != "following"}
        following, leaf = arrays["following"], arrays["feature"] == LEAF
        rows = np.cumsum(leaf) - 1
        if following.shape != rows.shape or not np.array_equal(following[leaf], rows[leaf]):
            raise ValueError("its leaves and their values do not fit together")
        left = np.arange(1, len(following) + 1, dtype=np.int32)
        return cls(children=np.stack([left, following], axis=1), **others)
