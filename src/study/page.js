'use strict';
const all = document.querySelectorAll('.pictures img');
const [under, over] = ['under', 'over'].map((id) => document.getElementById(id));
const [left, right] = ['left', 'right'].map((id) => document.getElementById(id));
const split = document.getElementById('split');
const stage = document.getElementById('stage');
const show = () => {
  over.src = all[left.value].src;
  under.src = all[right.value].src;
};
const move = () => stage.style.setProperty('--split', split.value + '%');
left.addEventListener('change', show);
right.addEventListener('change', show);
split.addEventListener('input', move);
document.querySelectorAll('[data-left]').forEach((button) => button.addEventListener('click', () => {
  left.value = button.dataset.left;
  right.value = button.dataset.right;
  show();
  document.getElementById('compare').scrollIntoView();
}));
show();
move();
