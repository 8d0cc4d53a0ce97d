import { mount } from 'svelte';
import './app.css';
import App from './App.svelte';
import { speakAsBefore } from './text/words.svelte';

const target = document.getElementById('app');
if (target === null) throw new Error('index.html has no #app');
speakAsBefore();
mount(App, { target });
